// Works off the queue of jobs (store/job_queue.h), one at a time, each by the command line program as a child process:
// a file that crashes a decoder ends its job, not the server, and a job does exactly what the same command does.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "victorious/base/child_task.h"
#include "victorious/base/error.h"
#include "victorious/base/file_roots.h"
#include "victorious/store/job_queue.h"

namespace victorious {

struct JobFolders {
  std::string index;                         ///< by the name that OpenStore takes; without a password
  std::filesystem::path models;              ///< the model library; empty: no job can run
  std::filesystem::path copies;              ///< where the files go that are made for users
  std::filesystem::path categories = {};     ///< the category model that videos are searched for; empty: none
  FileRoots files = {};                      ///< that a job may read
  std::filesystem::path uploads = {};        ///< where uploaded files go, and the flight of the sample
  std::filesystem::path sample_scene = {};   ///< of the sample; empty: there is none
  std::filesystem::path sample_object = {};  ///< the CAD file of the sample, which may be read, too
  std::filesystem::path certificates = {};   ///< that servers of live sources are verified by; empty: the system's
};

/// The arguments of `victorious` that do a job. The queue is a part of the index, which may come from elsewhere: what a
/// job reads and writes is checked again. Errors: kInvalidArgument for an input that is not valid, with the member that
/// is wrong; kPermissionDenied for a file that may not be read.
///   index  {"video": path, "telemetry": path or null}
///   live   {"video": URL, "telemetry": path or null}
///   track  {"video": path, "at_s": number, "box": [x, y, w, h], "type": text or null, "telemetry": path or null}
///   copy   {"video": path, "copy": path}
///   clip   {"video": name in the index, "object": id, "from_s", "to_s": numbers or null, "telemetry": path or null,
///          "clip": path}
///   remove {"video": name in the index} or {"model": name in the index}
///   refine {"categories": path, "refine": path}
///   model  {"name": text, "files": [path, …], "length_m": number or null, "box": [x, y, w, h] or null}
[[nodiscard]] Expected<std::vector<std::string>> JobArguments(const JobRecord& job, const JobFolders& folders);

/// Whether a job of this kind makes a file that is kept for all users who ask for the same. Its input names that file
/// by the text of the kind.
[[nodiscard]] constexpr bool MakesFile(JobKind kind) {
  return kind == JobKind::kCopy || kind == JobKind::kClip || kind == JobKind::kRefine;
}

/// How the names of the refined category models of an index begin in the folder of copies. Other servers may have files
/// of other indexes there.
[[nodiscard]] std::string RefinedPrefix(const std::string& index);

/// The file that a job makes for users; std::nullopt: none, or an input that is not valid.
[[nodiscard]] std::optional<std::filesystem::path> MadeFileOf(const JobRecord& job);

/// Removes the temporary files of a copy, FILE.tmp-…, which a killed process left. Nobody may be writing it.
void RemoveUnfinishedCopies(const std::filesystem::path& copy);

/// Updates the progress by an event of the job's process. Returns false for an event that changes nothing of it.
bool ApplyEvent(const ProgramEvent& event, JobProgress& progress);

class JobRunner {
 public:
  struct Options {
    std::chrono::milliseconds lease{6'000};
    std::chrono::milliseconds renewal{1'000};  ///< interval
    std::chrono::milliseconds poll{1'000};     ///< looks for jobs of other processes
    std::vector<JobKind> kinds = {};           ///< that it works on
    /// The process of a job, by its arguments: this program, but for tests.
    std::function<ChildCommand(const std::vector<std::string>&)> command = &OwnProgram;
  };

  /// @param queue       used by this runner's thread only
  /// @param on_change   called from that thread after each change of a job
  JobRunner(std::unique_ptr<JobQueue> queue, JobFolders folders, std::function<void()> on_change, Options options);
  /// Interrupts the present job, which goes back to the queue, and ends.
  ~JobRunner();
  /// Begins what the destructor waits for.
  void BeginToEnd();

  /// There may be a new job, or one to be cancelled.
  void Wake();

 private:
  void Run();
  /// @param claimed  before the job was asked for
  void Work(const JobRecord& job, std::chrono::steady_clock::time_point claimed);
  void WaitForWork();

  std::unique_ptr<JobQueue> queue_;
  JobFolders folders_;
  std::function<void()> on_change_;
  Options options_;
  std::string worker_name_;
  std::mutex mutex_;
  std::condition_variable woken_;
  bool is_woken_ = false;
  std::atomic<bool> is_ending_ = false;
  std::thread thread_;
};

}  // namespace victorious

// What goes on while the server runs: jobs of users, and events about them and about the index for every open page.
// Thread-safe.
#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "victorious/apps/serve/copy_folder.h"
#include "victorious/apps/serve/event_hub.h"
#include "victorious/apps/serve/index_view.h"
#include "victorious/apps/serve/job_runner.h"
#include "victorious/base/error.h"
#include "victorious/store/job_queue.h"

namespace victorious {

class LiveService {
 public:
  /// @param index, copies  must outlive this
  /// @param folders        without models: no jobs, only events
  /// Errors: those of OpenJobQueue.
  [[nodiscard]] static Expected<std::unique_ptr<LiveService>> Start(IndexView& index, CopyFolder& copies,
                                                                    const JobFolders& folders);
  ~LiveService();

  [[nodiscard]] bool has_jobs() const { return queue_ != nullptr; }
  /// Events `index` ({"version", "newest_object"}) when the index changes, `jobs` (the list of jobs) when a job does.
  /// @param is_open  there are no accounts: who listens may know why sources cannot be read; else nobody hears it here
  [[nodiscard]] std::shared_ptr<EventFeed> Listen(bool is_open) {
    if (!is_open) has_accounts_ = true;
    return hub_->Listen();
  }

  /// Errors of these: kUnsupported without jobs; those of JobQueue.
  [[nodiscard]] Expected<JobRecord> Submit(const NewJob& job);
  [[nodiscard]] Expected<JobRecord> SubmitOnce(const NewJob& job);
  [[nodiscard]] Expected<JobRecord> Cancel(std::int64_t job, const std::string& actor);
  [[nodiscard]] Expected<JobRecord> Retry(std::int64_t job, const std::string& actor);
  [[nodiscard]] Status Remove(std::int64_t job, const std::string& actor);
  /// Without jobs: none.
  [[nodiscard]] Expected<std::vector<JobRecord>> Jobs();
  [[nodiscard]] Expected<std::optional<JobRecord>> Find(std::int64_t job);

 private:
  LiveService(IndexView& index, CopyFolder& copies, std::string refined_prefix, std::unique_ptr<JobQueue> queue)
      : index_(index), copies_(copies), refined_prefix_(std::move(refined_prefix)), queue_(std::move(queue)) {}

  [[nodiscard]] Status CheckHasJobs() const;
  void WakeRunners();
  void Watch();
  void TrimCopies();
  /// Removes the refined category models that no listed job has made.
  void RemoveRefined();
  void PublishIndex();
  [[nodiscard]] Status PublishNewIndex();
  void PublishJobs();

  IndexView& index_;
  CopyFolder& copies_;
  std::string refined_prefix_;
  std::shared_ptr<EventHub> hub_ = std::make_shared<EventHub>();
  std::mutex queue_mutex_;
  std::unique_ptr<JobQueue> queue_;  ///< null: no jobs
  std::atomic<bool> is_ending_ = false;
  std::atomic<bool> jobs_changed_ = true;
  std::atomic<bool> has_accounts_ = false;
  std::int64_t published_version_ = 0;
  std::string index_failure_;  ///< the last one, until there is none
  std::optional<std::chrono::steady_clock::time_point> trimmed_;
  std::vector<std::unique_ptr<JobRunner>> runners_;
  std::thread watcher_;
};

}  // namespace victorious

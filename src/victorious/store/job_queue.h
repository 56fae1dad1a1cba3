// A queue of jobs that survives a kill of everyone who works on it, in the words of work_state.h. Input: jobs of users
// (from serve/). Output: the jobs, one at a time, to whoever claims them. It is kept in the index.
//
// A queued job that is cancelled ends at once; a running one once its worker, which learns it from Renew, has stopped
// it. A lost lease is another attempt, the tenth without coming further a failure. All times are given by the caller,
// microseconds since 1970.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "victorious/base/enum_text.h"
#include "victorious/base/error.h"
#include "victorious/store/work_state.h"

namespace victorious {

/// What a job does. Each kind has its own input (apps/serve/job_runner.h).
enum class JobKind {
  kIndex,   ///< searches a video
  kModel,   ///< makes a model
  kCopy,    ///< copies a video for browsers
  kClip,    ///< cuts and draws the moments of an object
  kLive,    ///< searches a live source as it comes
  kTrack,   ///< follows a box of a frame
  kRefine,  ///< refines the categories by what was reviewed
  kSample,  ///< simulates the flight of the sample
  kRemove,  ///< takes a video or a model out of the index
};

/// The texts in the index and in the API.
inline constexpr auto kJobKindTexts = std::to_array<EnumText<JobKind>>({{JobKind::kIndex, "index"},
                                                                        {JobKind::kModel, "model"},
                                                                        {JobKind::kCopy, "copy"},
                                                                        {JobKind::kClip, "clip"},
                                                                        {JobKind::kLive, "live"},
                                                                        {JobKind::kTrack, "track"},
                                                                        {JobKind::kRefine, "refine"},
                                                                        {JobKind::kSample, "sample"},
                                                                        {JobKind::kRemove, "remove"}});

constexpr std::string_view ToText(JobKind kind) { return ToText(kJobKindTexts, kind); }

/// A job whose workers are killed so often, without it coming further, has failed. More than for tasks (kMaxAttempts):
/// one process works on all jobs of a server, and is killed for other reasons than the job that it works on.
inline constexpr int kMaxJobAttempts = 10;

/// How far a job has come.
struct JobProgress {
  std::int64_t done = 0;
  std::optional<std::int64_t> total;  ///< std::nullopt: not known
  std::string unit;                   ///< of both, as in "frames"
  std::string message;                ///< the present step, or how it ended
  std::optional<double> behind_s;     ///< of a live source (ProgressEvent); std::nullopt: none, or not known yet
};

struct JobRecord {
  std::int64_t id = 0;
  JobKind kind = JobKind::kIndex;
  std::string input_json;  ///< what the kind needs
  WorkState state = WorkState::kQueued;
  std::int64_t created_utc_us = 0;
  std::optional<std::int64_t> started_utc_us;  ///< of the present attempt
  std::optional<std::int64_t> ended_utc_us;
  std::string worker;  ///< that has it; empty: none
  int attempts = 0;    ///< claims since it came further than before, with that one; without those that were released
  bool cancel_asked = false;
  JobProgress progress;
};

/// A job that somebody asks for.
struct NewJob {
  JobKind kind = JobKind::kIndex;
  std::string input_json;  ///< what the kind needs
  std::int64_t now_us = 0;
  std::string actor = {};   ///< who asks, for the log; empty: nobody in particular
  std::string logged = {};  ///< JSON for the log instead of the input, if that contains a secret
};

struct SubmittedJob {
  JobRecord job;
  bool is_new = true;  ///< false: it was asked for before
};

/// Not thread-safe: use from one thread at a time. Any number of processes may use the same queue. What a user asks for
/// is in the log of who did what (audit_record.h). A job of a kind that this program does
/// not know is not listed and not claimed; what names it fails with kUnsupported.
class JobQueue {
 public:
  virtual ~JobQueue() = default;

  [[nodiscard]] virtual Expected<JobRecord> Submit(const NewJob& job) = 0;
  /// As Submit, unless a job of this kind and input is open: then returns that one. Of two callers at once, one submits
  /// it.
  [[nodiscard]] virtual Expected<SubmittedJob> SubmitOnce(const NewJob& job) = 0;
  /// Takes the oldest job of these kinds that is queued or whose lease has run out; std::nullopt: there is none. A job
  /// whose lease has run out in its last attempt (kMaxJobAttempts) fails instead, and one that was to be cancelled is
  /// cancelled.
  [[nodiscard]] virtual Expected<std::optional<JobRecord>> Claim(const std::string& worker,
                                                                 std::span<const JobKind> kinds, std::int64_t now_us,
                                                                 std::int64_t lease_us) = 0;
  /// Prolongs the lease and stores the progress. Returns false if the job is to be cancelled. Error: kConflict if the
  /// job is not this worker's (any more): stop working on it.
  [[nodiscard]] virtual Expected<bool> Renew(std::int64_t job, const std::string& worker, std::int64_t now_us,
                                             std::int64_t lease_us, const JobProgress& progress) = 0;
  /// Ends a job that is done. Error: as for Renew.
  [[nodiscard]] virtual Status Complete(std::int64_t job, const std::string& worker, const std::string& message,
                                        std::int64_t now_us) = 0;
  /// Ends a job that failed; it is not tried again. Error: as for Renew.
  [[nodiscard]] virtual Status Fail(std::int64_t job, const std::string& worker, const std::string& message,
                                    std::int64_t now_us) = 0;
  /// Ends a job that Renew said is to be cancelled, and that its worker has stopped. Error: as for Renew.
  [[nodiscard]] virtual Status EndCancelled(std::int64_t job, const std::string& worker, std::int64_t now_us) = 0;
  /// Gives a job back that will be continued later; the attempt does not count. Error: as for Renew.
  [[nodiscard]] virtual Status Release(std::int64_t job, const std::string& worker) = 0;
  /// Cancels a queued job, asks the worker of a running one, leaves one that has ended. Returns it. Error: kNotFound.
  [[nodiscard]] virtual Expected<JobRecord> Cancel(std::int64_t job, std::int64_t now_us, const std::string& actor) = 0;
  /// Queues a job again that has failed or was cancelled, as if it were new. Returns it. Errors: kNotFound; kConflict
  /// for one that is open or done, and if another job of this kind and input is open.
  [[nodiscard]] virtual Expected<JobRecord> Retry(std::int64_t job, std::int64_t now_us, const std::string& actor) = 0;
  /// Removes a job that has ended; what it has made stays. Errors: kNotFound; kConflict for one that is open.
  [[nodiscard]] virtual Status Remove(std::int64_t job, std::int64_t now_us, const std::string& actor) = 0;

  [[nodiscard]] virtual Expected<std::optional<JobRecord>> Find(std::int64_t job) = 0;
  /// Returns the open jobs, oldest first, then the `limit` latest that have ended, latest first.
  [[nodiscard]] virtual Expected<std::vector<JobRecord>> List(std::int64_t limit) = 0;
  [[nodiscard]] virtual Expected<std::int64_t> CountOpen() = 0;
};

/// Opens the queue of an index, that OpenStore opens under this name. Errors: those of OpenStore(kCreate).
[[nodiscard]] Expected<std::unique_ptr<JobQueue>> OpenJobQueue(const std::string& name);

}  // namespace victorious

// A queue of jobs that survives a kill of everyone who works on it. Input: jobs of users (from serve/). Output: the jobs,
// one at a time, to whoever claims them. sqlite/ keeps it in the file of an index; a server database can implement it as
// well.
//
//            Claim               Finish
//   queued ---------> running -----------> done, failed, cancelled
//      ^                 |
//      '-----------------'  Release; an expired lease, of the first two workers. That of the third: failed
//
// A claim is a lease, which its worker renews (Beat); an expired lease is that of a dead worker. All times are given by
// the caller, microseconds since 1970.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "victorious/base/enum_text.h"
#include "victorious/base/error.h"

namespace victorious {

enum class JobState {
  kQueued,
  kRunning,
  kDone,
  kFailed,
  kCancelled,
};

/// The texts in the index and in the API.
inline constexpr auto kJobStateTexts = std::to_array<EnumText<JobState>>({{JobState::kQueued, "queued"},
                                                                          {JobState::kRunning, "running"},
                                                                          {JobState::kDone, "done"},
                                                                          {JobState::kFailed, "failed"},
                                                                          {JobState::kCancelled, "cancelled"}});

constexpr std::string_view ToText(JobState state) { return ToText(kJobStateTexts, state); }

/// How far a job has come.
struct JobProgress {
  std::int64_t done = 0;
  std::optional<std::int64_t> total;  ///< std::nullopt: not known
  std::string unit;                   ///< of both, as in "frames"
  std::string message;                ///< the present step, or how it ended
};

struct JobRecord {
  std::int64_t id = 0;
  std::string kind;
  std::string input_json;  ///< what the kind needs
  JobState state = JobState::kQueued;
  std::int64_t created_utc_us = 0;
  std::optional<std::int64_t> started_utc_us;  ///< of the present attempt
  std::optional<std::int64_t> ended_utc_us;
  std::string owner;  ///< the worker that has it; empty: none
  int attempts = 0;   ///< claims so far
  bool cancel_asked = false;
  JobProgress progress;
};

/// A job that somebody asks for.
struct NewJob {
  std::string kind;
  std::string input_json;  ///< what the kind needs
  std::int64_t now_us = 0;
  std::string actor = {};  ///< who asks, for the log; empty: nobody in particular
};

struct PutJob {
  JobRecord job;
  bool is_new = true;  ///< false: it was asked for before
};

/// Not thread-safe: use from one thread at a time. Any number of processes may use the same queue. What a user asks for is
/// in the log of who did what (audit_record.h).
class JobQueue {
 public:
  static constexpr int kMaxAttempts = 3;

  virtual ~JobQueue() = default;

  [[nodiscard]] virtual Expected<JobRecord> Put(const NewJob& job) = 0;
  /// As Put, unless a job of this kind and input waits or runs: then returns that one. Of two callers at once, one puts
  /// it.
  [[nodiscard]] virtual Expected<PutJob> PutOnce(const NewJob& job) = 0;
  /// Takes the oldest job that is queued or whose lease has run out; std::nullopt: there is none. A job whose lease has
  /// run out in its last attempt fails instead, and one that was to be cancelled is cancelled.
  [[nodiscard]] virtual Expected<std::optional<JobRecord>> Claim(const std::string& owner, std::int64_t now_us,
                                                                 std::int64_t lease_us) = 0;
  /// Renews the lease and stores the progress. Returns false if the job is to be cancelled. Error: kConflict if the job
  /// is not this owner's (any more): stop working on it.
  [[nodiscard]] virtual Expected<bool> Beat(std::int64_t job, const std::string& owner, std::int64_t now_us,
                                            std::int64_t lease_us, const JobProgress& progress) = 0;
  /// Ends a job: kDone, kFailed or kCancelled. Error: as for Beat.
  [[nodiscard]] virtual Status Finish(std::int64_t job, const std::string& owner, JobState state,
                                      const std::string& message, std::int64_t now_us) = 0;
  /// Gives a job back that will be continued later; the attempt does not count. Error: as for Beat.
  [[nodiscard]] virtual Status Release(std::int64_t job, const std::string& owner) = 0;
  /// Cancels a job that waits, asks the worker of one that runs, leaves one that has ended. Returns it. Error: kNotFound.
  [[nodiscard]] virtual Expected<JobRecord> Cancel(std::int64_t job, std::int64_t now_us, const std::string& actor) = 0;

  [[nodiscard]] virtual Expected<std::optional<JobRecord>> Find(std::int64_t job) = 0;
  /// Returns the jobs that have not ended, oldest first, then the `limit` latest that have, latest first.
  [[nodiscard]] virtual Expected<std::vector<JobRecord>> List(std::int64_t limit) = 0;
  [[nodiscard]] virtual Expected<std::int64_t> CountWaiting() = 0;
};

/// Opens the queue of an index. Errors: those of OpenSqliteStore(kCreate).
[[nodiscard]] Expected<std::unique_ptr<JobQueue>> OpenSqliteJobQueue(const std::filesystem::path& path);

}  // namespace victorious

// A queue of tasks for workers, in the words of work_state.h, in the database of the index that they write.
//
// Claims do not wait for each other (SELECT … FOR UPDATE SKIP LOCKED). Only the attempt that runs can be renewed or
// ended. An attempt that fails, or loses its lease, is followed by another one, after growing delays; after
// kMaxAttempts failures without progress the task has failed. Lost leases and kills from outside are counted apart, up
// to kMaxKills: they say more of the machine than of the task. Submitted again, it is queued again. Results are stored
// with the progress by compare-and-swap (IndexStore::Commit), so that each task takes effect once. No transaction is
// open while a worker computes.
//
// A task may be done in parts, tasks of their own: it waits until none of them is open, and is then queued again. A
// part that failed by its own error fails the task, too; one that killed who did it is left to the task (FatalParts).
//
// A lasting task has no end of its own: a live source. Lost leases do not fail it, and it is not counted with the
// others. End() ends it.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/store/postgres/connection.h"
#include "victorious/store/work_state.h"

namespace victorious::postgres {

/// What is claimed first.
enum class TaskPriority {
  kLive = 0,    ///< a live source, whose frames do not wait
  kPerson = 1,  ///< somebody waits for it
  kBatch = 2,
};

struct NewTask {
  std::string kind;  ///< what is to be done
  std::string key;   ///< with what; a task of the same kind and key is added once
  TaskPriority priority = TaskPriority::kBatch;
  std::string payload;      ///< for the worker, as JSON
  std::string program;      ///< the build that shall do it (ProgramId): others may find other things
  bool is_undone = false;   ///< its results are not in the index (any more): it is queued again, even if it was done
  bool is_lasting = false;  ///< goes on until it is ended
};

/// What became of submitted tasks.
struct Submission {
  std::int64_t added = 0;  ///< new, or queued again, or changed: another program or payload, a higher priority
  std::int64_t done = 0;   ///< done before, and still
};

/// A claimed task.
struct Task {
  std::int64_t id = 0;
  std::int64_t attempt = 0;  ///< from 1; identifies the lease
  std::string kind;
  std::string key;
  std::string payload;
  std::int64_t failures = 0;           ///< attempts before this one that failed, since the last progress
  std::int64_t kills = 0;              ///< those that were killed from outside, or lost their lease, since then
  std::optional<std::int64_t> parent;  ///< the task of which it is a part
};

/// How an attempt failed.
enum class FailureKind {
  kError,   ///< its process said why
  kCrash,   ///< its process crashed by what it did
  kKilled,  ///< its process was killed from outside, as by a person or for lack of memory
};

/// Numbers of tasks by state.
struct TaskCounts {
  std::int64_t queued = 0;
  std::int64_t waiting = 0;  ///< for their parts
  std::int64_t running = 0;
  std::int64_t done = 0;
  std::int64_t failed = 0;

  bool operator==(const TaskCounts&) const = default;
};

/// A task, as a person sees it.
struct TaskRecord {
  std::int64_t id = 0;
  std::string kind;
  std::string key;
  std::string payload;
  WorkState state = WorkState::kRunning;
  std::int64_t attempt = 0;
  std::string worker;                  ///< that runs it
  std::optional<double> lease_left_s;  ///< of a running one
  std::optional<double> silent_s;      ///< of a running one: since its worker said last that it is alive
  std::string reason;                  ///< of the last failure; empty: none
  std::string program;
};

/// Which tasks are claimed.
enum class TaskChoice {
  kAll,
  kLasting,  ///< those without an end only
  kFinite,   ///< the others
};

/// Which lasting tasks are listed.
enum class LastingTasks {
  kOpen,  ///< those that are not done
  kAll,
};

struct TaskQueueOptions {
  std::string worker;   ///< the name of this process in the log
  std::string program;  ///< the build whose tasks it claims
  TaskChoice choice = TaskChoice::kAll;
  std::chrono::seconds lease{60};  ///< of its claims
  /// Before the second attempt of a task that failed; four times as long before the next. A shared disk may be away.
  std::chrono::seconds retry_delay{30};
  /// After which a statement that the server does not answer is an error (Connection::SetReplyTimeout).
  std::optional<std::chrono::milliseconds> reply_timeout = {};
  bool is_read_only = false;
};

/// Use from one thread at a time.
class TaskQueue {
 public:
  /// @param url  of an index that exists (OpenPostgresStore)
  [[nodiscard]] static Expected<std::unique_ptr<TaskQueue>> Open(const std::string& url, TaskQueueOptions options);

  /// @param connection  of an index of this version; `options.is_read_only` is a matter of the connection
  [[nodiscard]] static std::unique_ptr<TaskQueue> On(std::shared_ptr<Connection> connection, TaskQueueOptions options);

  [[nodiscard]] std::chrono::seconds lease() const { return options_.lease; }

  /// Adds the tasks, in one transaction. One that has failed, or is done and NewTask::is_undone, is queued again; a
  /// queued one gets the new program and payload; an open one and its parts get the higher priority. One that is being
  /// ended goes on.
  [[nodiscard]] Expected<Submission> Submit(std::span<const NewTask> tasks);

  /// Claims the queued task of this program with the highest priority, of these the one that was added first, or whose
  /// parent was; std::nullopt if there is none. Ends the leases of dead workers first: each is a failed attempt, unless
  /// the server itself was started after the last renewal.
  [[nodiscard]] Expected<std::optional<Task>> Claim();

  /// Renews the lease from now on. Returns false if the task is to be ended (End). Error: kConflict if the lease was
  /// lost.
  /// @param has_progress  results were stored since the last renewal: its former failures do not count any more
  [[nodiscard]] Expected<bool> Renew(const Task& task, bool has_progress);

  /// The positions of the searches of a video, summed over models: a measure of progress.
  [[nodiscard]] Expected<std::int64_t> Progress(const std::string& video);

  /// Ends the task: its results are stored. Error: kConflict if the lease was lost.
  [[nodiscard]] Status Complete(const Task& task);

  /// Ends an attempt that failed: the task is queued again, for `retry_delay` from now or later, or has failed. Error:
  /// kConflict if the lease was lost.
  [[nodiscard]] Status Fail(const Task& task, const std::string& reason, FailureKind kind = FailureKind::kError);

  /// Ends an attempt whose task goes on in parts: the task waits, and its parts are queued with its priority, also
  /// those that had ended before. Error: kConflict if the lease was lost; then no part is added.
  [[nodiscard]] Status Wait(const Task& task, std::span<const NewTask> parts);

  /// The parts of a task that have failed because every attempt killed its process or its worker.
  [[nodiscard]] Expected<std::vector<TaskRecord>> FatalParts(const Task& task);

  /// Sets a part that has failed aside: others do its work. It is done.
  [[nodiscard]] Status CloseFailed(std::int64_t task);

  /// Fails a task that no attempt can do. Error: kConflict if the lease was lost.
  [[nodiscard]] Status Reject(const Task& task, const std::string& reason);

  /// Gives the task back, as at a shutdown; it is not claimed before `delay` is over. Error: kConflict if the lease was
  /// lost.
  [[nodiscard]] Status Release(const Task& task, std::chrono::seconds delay = {},
                               const std::optional<std::string>& reason = {});

  /// Ends a lasting task: at once, or once its worker has renewed its lease and its process has ended in order.
  /// Submitted again, it begins again. Without effect on any other task.
  [[nodiscard]] Status End(std::int64_t task);

  /// Gives the task of a lost lease back that could not be renewed because the database did not answer: its loss is no
  /// failed attempt. Without effect if it has ended otherwise.
  [[nodiscard]] Status Excuse(const Task& task);

  /// Gives back what this worker has claimed, as after a claim whose answer did not arrive.
  [[nodiscard]] Status ReleaseOwn();

  /// Of the tasks that are no parts and not lasting.
  [[nodiscard]] Expected<TaskCounts> Count();
  [[nodiscard]] Expected<TaskCounts> CountParts();

  /// Returns the lasting tasks, by id.
  [[nodiscard]] Expected<std::vector<TaskRecord>> ListLasting(LastingTasks which = LastingTasks::kOpen);

  /// Returns the other tasks that run, then those that have failed, by id; at most `limit` of each.
  [[nodiscard]] Expected<std::vector<TaskRecord>> List(std::int64_t limit);

  /// Returns the tasks of a kind that are queued, wait or run, and whose key begins with one of these words and a
  /// blank, by id.
  /// @param words  without blanks, commas, quotes, braces and backslashes, as hashes are
  [[nodiscard]] Expected<std::vector<TaskRecord>> FindOpen(std::string_view kind, std::span<const std::string> words);

  /// Whether a task of this program and choice is open.
  [[nodiscard]] Expected<bool> HasOpenTasks();

  /// Returns the mean time from claim to end of the last 1000 tasks done, of those without parts; std::nullopt if none
  /// was done.
  [[nodiscard]] Expected<std::optional<double>> MeanSeconds() { return MeanSeconds(false); }
  /// The same of parts.
  [[nodiscard]] Expected<std::optional<double>> MeanPartSeconds() { return MeanSeconds(true); }

 private:
  TaskQueue(std::shared_ptr<Connection> connection, TaskQueueOptions options)
      : connection_(std::move(connection)), options_(std::move(options)) {}

  [[nodiscard]] Expected<TaskCounts> Count(bool of_parts);
  [[nodiscard]] Expected<std::optional<double>> MeanSeconds(bool of_parts);
  [[nodiscard]] Status EndLostLeases();
  /// Queues the waiting tasks without an open part, or one of them.
  [[nodiscard]] Status Wake(std::optional<std::int64_t> task);
  /// Wakes the task of a part that has ended.
  [[nodiscard]] Status WakeParent(const Task& part);
  /// Ends the lease: the task gets a new state and reason, the log an event.
  [[nodiscard]] Status EndLease(const Task& task, WorkState state, const std::optional<std::string>& reason,
                                std::string_view event, std::chrono::seconds delay = {});
  [[nodiscard]] std::unexpected<Error> LostLease(const Task& task) const;

  std::shared_ptr<Connection> connection_;
  TaskQueueOptions options_;
};

}  // namespace victorious::postgres

// Tasks that are shared out to workers, in the database of the index that they write.
//
// A worker claims one task at a time by SELECT … FOR UPDATE SKIP LOCKED, so that claims do not wait for each other. A claim
// is a lease, renewed while the worker lives. A lease that ends without a word is that of a dead worker: the task waits
// again with the next attempt, or is quarantined if it failed or lost its worker three times. The end of an attempt is
// refused unless it still runs. A worker stores results with its progress by compare-and-swap (IndexStore::Commit), so
// that each task takes effect once, whatever dies or stands still meanwhile. No transaction is open while it computes.
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
  std::string payload;  ///< for the worker, as JSON
};

/// A claimed task.
struct Task {
  std::int64_t id = 0;
  std::int64_t attempt = 0;  ///< from 1; identifies the lease
  std::string kind;
  std::string key;
  std::string payload;
};

/// Numbers of tasks by state.
struct TaskCounts {
  std::int64_t waiting = 0;
  std::int64_t running = 0;
  std::int64_t done = 0;
  std::int64_t quarantined = 0;

  bool operator==(const TaskCounts&) const = default;
};

/// A task that is not done, as a person sees it.
struct TaskState {
  std::int64_t id = 0;
  std::string kind;
  std::string payload;
  bool is_quarantined = false;  ///< otherwise it runs
  std::int64_t attempt = 0;
  std::string worker;                  ///< that runs it
  std::optional<double> lease_left_s;  ///< of a running one
  std::string reason;                  ///< of the last failure; empty: none
};

/// Use from one thread at a time.
class TaskQueue {
 public:
  static constexpr std::chrono::seconds kLease{60};
  static constexpr int kMaxFailures = 3;

  /// @param url     of an index that exists (OpenPostgresStore)
  /// @param worker  the name of this process in the log
  /// @param lease   of this worker's claims
  [[nodiscard]] static Expected<std::unique_ptr<TaskQueue>> Open(const std::string& url, std::string worker,
                                                                 std::chrono::seconds lease = kLease);

  [[nodiscard]] std::chrono::seconds lease() const { return lease_; }

  /// Adds the tasks, in one transaction; one that is quarantined waits again. Returns the number of those that are new or
  /// wait again.
  [[nodiscard]] Expected<std::int64_t> Submit(std::span<const NewTask> tasks);

  /// Claims the waiting task of the highest priority, of these the one that was added first; std::nullopt if none waits.
  /// Ends the leases of dead workers first.
  [[nodiscard]] Expected<std::optional<Task>> Claim();

  /// Renews the lease from now on. Error: kConflict if it was lost.
  [[nodiscard]] Status Renew(const Task& task);

  /// Ends the task: its results are stored. Error: kConflict if the lease was lost.
  [[nodiscard]] Status Complete(const Task& task);

  /// Ends a failed attempt: the task waits again, or is quarantined after kMaxFailures. Error: kConflict if the lease was
  /// lost.
  [[nodiscard]] Status Abandon(const Task& task, const std::string& reason);

  /// Gives the task back, as at a shutdown: it waits again. Error: kConflict if the lease was lost.
  [[nodiscard]] Status Return(const Task& task);

  /// Quarantines a task that cannot be done, with the reason. Error: kConflict if the lease was lost.
  [[nodiscard]] Status Quarantine(const Task& task, const std::string& reason);

  [[nodiscard]] Expected<TaskCounts> Count();

  /// Returns the tasks that run, then those that are quarantined, by id; at most `limit` of each.
  [[nodiscard]] Expected<std::vector<TaskState>> List(std::int64_t limit);

  /// Returns the tasks done an hour, over the last hour, or since the first one was claimed in it; std::nullopt if none
  /// was done.
  [[nodiscard]] Expected<std::optional<double>> DonePerHour();

 private:
  TaskQueue(std::unique_ptr<Connection> connection, std::string worker, std::chrono::seconds lease)
      : connection_(std::move(connection)), worker_(std::move(worker)), lease_(lease) {}

  [[nodiscard]] Status EndLostLeases();
  /// Ends the lease in a transaction: the task gets a new state and reason, the log an event.
  [[nodiscard]] Status EndLease(const Task& task, std::string_view state, std::optional<std::string> reason,
                                std::string_view event);
  [[nodiscard]] Status Log(const Task& task, std::string_view event);
  [[nodiscard]] std::unexpected<Error> LostLease(const Task& task) const;

  std::unique_ptr<Connection> connection_;
  std::string worker_;
  std::chrono::seconds lease_;
};

}  // namespace victorious::postgres

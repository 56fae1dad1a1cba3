// Tasks that are shared out to workers, in the database of the index that they write.
//
// A worker claims one task at a time by SELECT … FOR UPDATE SKIP LOCKED, so that claims do not wait for each other. A claim
// is a lease, renewed while the worker lives. A lease that ends without a word is that of a dead worker: the task waits
// again with the next attempt, or is quarantined if it lost its worker three times. The results of a task and its end
// are one transaction, refused unless this attempt still runs: each task takes effect once, whatever dies or stands
// still meanwhile. No transaction is open while a worker computes.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

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

/// Use from one thread at a time; one that renews needs a queue of its own.
class TaskQueue {
 public:
  static constexpr std::chrono::seconds kLease{60};
  static constexpr int kMaxLostWorkers = 3;

  /// @param url     of an index that exists (OpenPostgresStore)
  /// @param worker  the name of this process in the log
  [[nodiscard]] static Expected<std::unique_ptr<TaskQueue>> Open(const std::string& url, std::string worker);

  /// Adds the tasks, in one transaction. Returns the number of those that are new.
  [[nodiscard]] Expected<std::int64_t> Submit(std::span<const NewTask> tasks);

  /// Claims the waiting task of the highest priority, of these the one that was added first; std::nullopt if none waits.
  /// Ends the leases of dead workers first.
  [[nodiscard]] Expected<std::optional<Task>> Claim();

  /// Renews the lease by kLease from now. Error: kConflict if it was lost.
  [[nodiscard]] Status Renew(const Task& task);

  /// Ends the task: `write` writes its results in the same transaction. Error: kConflict if the lease was lost, that of
  /// `write`; nothing is written then.
  [[nodiscard]] Status Complete(const Task& task, const std::function<Status(Connection&)>& write);

  /// Gives the task back, as at a shutdown: it waits again. Error: kConflict if the lease was lost.
  [[nodiscard]] Status Return(const Task& task);

  /// Quarantines a task that cannot be done, with the reason. Error: kConflict if the lease was lost.
  [[nodiscard]] Status Quarantine(const Task& task, const std::string& reason);

  [[nodiscard]] Expected<TaskCounts> Count();

 private:
  TaskQueue(std::unique_ptr<Connection> connection, std::string worker)
      : connection_(std::move(connection)), worker_(std::move(worker)) {}

  [[nodiscard]] Status EndLostLeases();
  /// Ends the lease in a transaction, after `write`: the task gets a new state and reason, the log an event.
  [[nodiscard]] Status EndLease(const Task& task, std::string_view state, std::optional<std::string> reason,
                                std::string_view event, const std::function<Status(Connection&)>& write);
  [[nodiscard]] std::unexpected<Error> LostLease(const Task& task) const;

  std::unique_ptr<Connection> connection_;
  std::string worker_;
};

}  // namespace victorious::postgres

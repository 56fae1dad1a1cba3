#include "victorious/store/postgres/task_queue.h"

#include <fmt/format.h>

#include "victorious/store/postgres/migrations.h"

namespace victorious::postgres {

Expected<std::unique_ptr<TaskQueue>> TaskQueue::Open(const std::string& url, std::string worker) {
  VICTORIOUS_ASSIGN_OR_RETURN(auto connection, Connection::Open(url, false));
  VICTORIOUS_RETURN_IF_ERROR(CheckVersion(*connection));
  return std::unique_ptr<TaskQueue>(new TaskQueue(std::move(connection), std::move(worker)));
}

Expected<std::int64_t> TaskQueue::Submit(std::span<const NewTask> tasks) {
  CopyRows rows;
  for (const NewTask& task : tasks) rows.AddRow(task.kind, task.key, static_cast<int>(task.priority), task.payload);
  VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_, Exclusion::kNothing));
  VICTORIOUS_RETURN_IF_ERROR(
      connection_->Execute("CREATE TEMPORARY TABLE new_tasks (position bigint GENERATED ALWAYS AS IDENTITY, kind text, "
                           "key text, priority bigint, payload text) ON COMMIT DROP"));
  VICTORIOUS_RETURN_IF_ERROR(connection_->Copy("new_tasks (kind, key, priority, payload)", rows));
  VICTORIOUS_ASSIGN_OR_RETURN(const Result added,
                              connection_->Query("INSERT INTO tasks (kind, key, priority, payload) SELECT kind, key, "
                                                 "priority, payload FROM new_tasks ORDER BY position "
                                                 "ON CONFLICT (kind, key) DO NOTHING"));
  VICTORIOUS_RETURN_IF_ERROR(transaction.Commit());
  return added.Changes();
}

Status TaskQueue::EndLostLeases() {
  VICTORIOUS_ASSIGN_OR_RETURN(
      const Result ended,
      connection_->Query(
          "WITH lost AS (SELECT id, worker FROM tasks WHERE state = 'running' AND leased_until < now() "
          "FOR UPDATE SKIP LOCKED), ended AS (UPDATE tasks t SET lost_workers = t.lost_workers + 1, "
          "leased_until = NULL, worker = NULL, "
          "state = CASE WHEN t.lost_workers + 1 < ? THEN 'waiting' ELSE 'quarantined' END, "
          "reason = CASE WHEN t.lost_workers + 1 < ? THEN NULL ELSE 'lost its worker ' || (t.lost_workers + 1) || "
          "' times' END FROM lost WHERE t.id = lost.id RETURNING t.id, t.attempt, lost.worker) "
          "INSERT INTO task_log (task_id, attempt, event, worker) SELECT id, attempt, 'lost', worker FROM ended",
          kMaxLostWorkers, kMaxLostWorkers));
  return {};
}

Expected<std::optional<Task>> TaskQueue::Claim() {
  VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_, Exclusion::kNothing));
  VICTORIOUS_RETURN_IF_ERROR(EndLostLeases());
  VICTORIOUS_ASSIGN_OR_RETURN(
      Result row,
      connection_->Query("WITH next AS (SELECT id FROM tasks WHERE state = 'waiting' ORDER BY priority, id LIMIT 1 "
                         "FOR UPDATE SKIP LOCKED) UPDATE tasks t SET state = 'running', attempt = t.attempt + 1, "
                         "worker = ?, leased_until = now() + ? * interval '1 s' FROM next WHERE t.id = next.id "
                         "RETURNING t.id, t.attempt, t.kind, t.key, t.payload",
                         worker_, static_cast<double>(kLease.count())));
  std::optional<Task> task;
  if (row.Next()) {
    task = {.id = row.Integer(0),
            .attempt = row.Integer(1),
            .kind = row.Text(2),
            .key = row.Text(3),
            .payload = row.Text(4)};
    VICTORIOUS_RETURN_IF_ERROR(
        connection_->Query("INSERT INTO task_log (task_id, attempt, event, worker) VALUES (?, ?, 'claimed', ?)",
                           task->id, task->attempt, worker_));
  }
  VICTORIOUS_RETURN_IF_ERROR(transaction.Commit());
  return task;
}

Status TaskQueue::Renew(const Task& task) {
  VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_, Exclusion::kNothing));
  VICTORIOUS_ASSIGN_OR_RETURN(
      const Result renewed,
      connection_->Query("UPDATE tasks SET leased_until = now() + ? * interval '1 s' WHERE id = ? AND attempt = ? AND "
                         "state = 'running'",
                         static_cast<double>(kLease.count()), task.id, task.attempt));
  if (renewed.Changes() != 1) return LostLease(task);
  return transaction.Commit();
}

Status TaskQueue::Complete(const Task& task, const std::function<Status(Connection&)>& write) {
  return EndLease(task, "done", std::nullopt, "done", write);
}

Status TaskQueue::Return(const Task& task) {
  return EndLease(task, "waiting", std::nullopt, "returned", [](Connection&) { return Status(); });
}

Status TaskQueue::Quarantine(const Task& task, const std::string& reason) {
  return EndLease(task, "quarantined", reason, "failed", [](Connection&) { return Status(); });
}

Status TaskQueue::EndLease(const Task& task, std::string_view state, std::optional<std::string> reason,
                           std::string_view event, const std::function<Status(Connection&)>& write) {
  VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_, Exclusion::kShared));
  // First, so that the row stays locked until the results are written: nobody else can end the lease.
  VICTORIOUS_ASSIGN_OR_RETURN(
      const Result ended,
      connection_->Query("UPDATE tasks SET state = ?, reason = ?, worker = NULL, leased_until = NULL "
                         "WHERE id = ? AND attempt = ? AND state = 'running'",
                         state, reason, task.id, task.attempt));
  if (ended.Changes() != 1) return LostLease(task);
  VICTORIOUS_RETURN_IF_ERROR(write(*connection_));
  VICTORIOUS_RETURN_IF_ERROR(
      connection_->Query("INSERT INTO task_log (task_id, attempt, event, worker) VALUES (?, ?, ?, ?)", task.id,
                         task.attempt, event, worker_));
  return transaction.Commit();
}

std::unexpected<Error> TaskQueue::LostLease(const Task& task) const {
  return Fail(ErrorCode::kConflict,
              fmt::format("{}: attempt {} of task {} ({} {}) does not run any more: it was not renewed for {} s, and "
                          "another worker may do it: claim a task again",
                          connection_->name(), task.attempt, task.id, task.kind, task.key, kLease.count()));
}

Expected<TaskCounts> TaskQueue::Count() {
  VICTORIOUS_ASSIGN_OR_RETURN(
      Result row, connection_->Query("SELECT count(*) FILTER (WHERE state = 'waiting'), count(*) FILTER (WHERE state = "
                                     "'running'), count(*) FILTER (WHERE state = 'done'), count(*) FILTER (WHERE state "
                                     "= 'quarantined') FROM tasks"));
  if (!row.Next()) return TaskCounts{};
  return TaskCounts{row.Integer(0), row.Integer(1), row.Integer(2), row.Integer(3)};
}

}  // namespace victorious::postgres

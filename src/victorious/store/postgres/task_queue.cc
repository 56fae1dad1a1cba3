#include "victorious/store/postgres/task_queue.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "victorious/store/postgres/migrations.h"

namespace victorious::postgres {
namespace {

// Of a worker's session. Tasks are read in the order of their indexes, whatever the server's statistics say: after a
// submission these are out of date, and every claim would sort all queued tasks. A scan of an index also learns which
// entries are of tasks that changed their state, while a bitmap scan reads them again each time. Plans are kept: making
// one takes longer than running it.
constexpr std::string_view kPlans =
    "-c enable_sort=off -c enable_bitmapscan=off -c enable_seqscan=off -c enable_hashjoin=off -c enable_mergejoin=off "
    "-c plan_cache_mode=force_generic_plan";

// The condition that a task is one of the choice.
std::string_view IsChosen(TaskChoice choice) {
  switch (choice) {
    case TaskChoice::kLasting:
      return "is_lasting";
    case TaskChoice::kFinite:
      return "NOT is_lasting";
    case TaskChoice::kAll:
      break;
  }
  return "true";
}

constexpr std::string_view kSelectRecords =
    "SELECT id, kind, payload, attempt, worker, extract(epoch FROM leased_until - now())::double precision, reason, "
    "program, extract(epoch FROM now() - renewed_at)::double precision, state, key FROM tasks ";

TaskRecord ReadTaskRecord(const Result& rows) {
  const WorkState state = FromText(kWorkStateTexts, rows.Text(9)).value_or(WorkState::kQueued);
  return {.id = rows.Integer(0),
          .kind = rows.Text(1),
          .key = rows.Text(10),
          .payload = rows.Text(2),
          .state = state,
          .attempt = rows.Integer(3),
          .worker = rows.Text(4),
          .lease_left_s = rows.OptionalReal(5),
          .silent_s = state == WorkState::kRunning ? rows.OptionalReal(8) : std::nullopt,
          .reason = rows.Text(6),
          .program = rows.Text(7)};
}

}  // namespace

Expected<std::unique_ptr<TaskQueue>> TaskQueue::Open(const std::string& url, TaskQueueOptions options) {
  VICTORIOUS_ASSIGN_OR_RETURN(auto connection,
                              Connection::Open(url, options.is_read_only, options.is_read_only ? "" : kPlans));
  if (options.reply_timeout) connection->SetReplyTimeout(*options.reply_timeout);
  VICTORIOUS_RETURN_IF_ERROR(CheckVersion(*connection));
  return On(std::move(connection), std::move(options));
}

std::unique_ptr<TaskQueue> TaskQueue::On(std::shared_ptr<Connection> connection, TaskQueueOptions options) {
  return std::unique_ptr<TaskQueue>(new TaskQueue(std::move(connection), std::move(options)));
}

Expected<Submission> TaskQueue::Submit(std::span<const NewTask> tasks) {
  CopyRows rows;
  for (const NewTask& task : tasks) {
    rows.AddRow(task.kind, task.key, static_cast<int>(task.priority), task.payload, task.program, int{task.is_undone},
                int{task.is_lasting});
  }
  VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_, Exclusion::kNothing));
  VICTORIOUS_RETURN_IF_ERROR(connection_->Execute(
      "CREATE TEMPORARY TABLE new_tasks (position bigint GENERATED ALWAYS AS IDENTITY, kind text, "
      "key text, priority bigint, payload text, program text, is_undone bigint, is_lasting bigint) "
      "ON COMMIT DROP"));
  VICTORIOUS_RETURN_IF_ERROR(
      connection_->Copy("new_tasks (kind, key, priority, payload, program, is_undone, is_lasting)", rows));
  VICTORIOUS_RETURN_IF_ERROR(connection_->Query(
      "UPDATE tasks t SET state = 'failed' FROM new_tasks n WHERE t.kind = n.kind AND t.key = n.key AND "
      "t.state = 'done' AND n.is_undone <> 0"));
  // The same task twice would be an error of the server.
  VICTORIOUS_ASSIGN_OR_RETURN(
      const Result added,
      connection_->Query(
          "INSERT INTO tasks (kind, key, priority, payload, program, is_lasting) "
          "SELECT kind, key, priority, payload, program, is_lasting <> 0 FROM "
          "(SELECT DISTINCT ON (kind, key) * FROM new_tasks ORDER BY kind, key, position) t ORDER BY position "
          "ON CONFLICT (kind, key) DO UPDATE SET state = 'queued', failures = 0, kills = 0, is_fatal = false, reason = "
          "NULL, "
          "not_before = NULL, "
          "payload = excluded.payload, program = excluded.program, "
          "priority = least(tasks.priority, excluded.priority) WHERE tasks.state = 'failed' OR "
          "(tasks.state = 'queued' AND (tasks.program <> excluded.program OR tasks.payload <> excluded.payload OR "
          "excluded.priority < tasks.priority)) OR "
          "(tasks.state = 'waiting' AND tasks.program <> excluded.program)"));
  // The parts that another build was to do.
  VICTORIOUS_RETURN_IF_ERROR(connection_->Query(
      "UPDATE tasks c SET state = 'done', reason = 'taken over by another build' FROM tasks p JOIN new_tasks n "
      "USING (kind, key) WHERE c.parent = p.id AND c.state IN ('queued', 'failed') AND c.program <> p.program"));
  // What runs or waits goes on, and what it still needs comes earlier.
  VICTORIOUS_ASSIGN_OR_RETURN(
      const Result raised,
      connection_->Query("UPDATE tasks t SET priority = n.priority FROM (SELECT kind, key, min(priority) AS priority "
                         "FROM new_tasks GROUP BY kind, key) n WHERE t.kind = n.kind AND t.key = n.key AND "
                         "t.state IN ('running', 'waiting') AND t.priority > n.priority"));
  VICTORIOUS_RETURN_IF_ERROR(
      connection_->Query("UPDATE tasks c SET priority = p.priority FROM tasks p JOIN new_tasks n USING (kind, key) "
                         "WHERE c.parent = p.id AND c.state IN ('queued', 'running') AND c.priority > p.priority"));
  VICTORIOUS_RETURN_IF_ERROR(connection_->Query(
      "UPDATE tasks t SET is_ending = false FROM new_tasks n WHERE t.kind = n.kind AND t.key = n.key AND t.is_ending"));
  VICTORIOUS_ASSIGN_OR_RETURN(
      Result done, connection_->Query("SELECT count(*) FROM tasks t JOIN (SELECT DISTINCT kind, key FROM new_tasks) n "
                                      "USING (kind, key) WHERE t.state = 'done'"));
  VICTORIOUS_RETURN_IF_ERROR(transaction.Commit());
  return Submission{.added = added.Changes() + raised.Changes(), .done = done.Next() ? done.Integer(0) : 0};
}

Status TaskQueue::EndLostLeases() {
  VICTORIOUS_ASSIGN_OR_RETURN(
      const Result ended,
      connection_->Write(
          "WITH lost AS (SELECT id, worker, CASE WHEN renewed_at < pg_postmaster_start_time() THEN 0 ELSE 1 END "
          "AS failed FROM tasks WHERE state = 'running' AND leased_until < now() "
          "FOR UPDATE SKIP LOCKED), ended AS (UPDATE tasks t SET kills = t.kills + failed, "
          "leased_until = NULL, worker = NULL, "
          "state = CASE WHEN is_ending THEN 'done' WHEN failed = 0 OR is_lasting OR t.kills + 1 < ? THEN 'queued' "
          "ELSE 'failed' END, is_ending = false, is_fatal = failed = 1, "
          "reason = CASE WHEN failed = 1 THEN 'its worker did not answer any more' "
          "ELSE 'the server was started again' END FROM lost WHERE t.id = lost.id "
          "RETURNING t.id, t.attempt, lost.worker, failed) "
          "INSERT INTO task_log (task_id, attempt, event, worker) "
          "SELECT id, attempt, CASE WHEN failed = 1 THEN 'lost' ELSE 'released' END, worker FROM ended",
          kMaxKills));
  return ended.Changes() > 0 ? Wake(std::nullopt) : Status();
}

// A part of another build does not count: the task was submitted again by this one.
Status TaskQueue::Wake(std::optional<std::int64_t> task) {
  VICTORIOUS_ASSIGN_OR_RETURN(
      const Result woken,
      connection_->Write(
          "UPDATE tasks p SET failures = 0, kills = 0, is_fatal = false, not_before = NULL, "
          "state = CASE WHEN EXISTS (SELECT FROM tasks c WHERE c.parent = p.id AND c.program = p.program AND "
          "c.state = 'failed' AND NOT c.is_fatal) THEN 'failed' ELSE 'queued' END, "
          "reason = (SELECT c.reason FROM tasks c WHERE c.parent = p.id AND c.program = p.program AND "
          "c.state = 'failed' AND NOT c.is_fatal ORDER BY c.id LIMIT 1) "
          "WHERE p.state = 'waiting' AND p.id = coalesce(?, p.id) AND NOT EXISTS (SELECT FROM tasks c WHERE "
          "c.parent = p.id AND c.program = p.program AND c.state IN ('queued', 'running'))",
          task));
  return {};
}

Status TaskQueue::WakeParent(const Task& part) { return part.parent ? Wake(part.parent) : Status(); }

Expected<std::optional<Task>> TaskQueue::Claim() {
  VICTORIOUS_RETURN_IF_ERROR(EndLostLeases());
  VICTORIOUS_ASSIGN_OR_RETURN(
      Result row,
      connection_->Write(
          fmt::format(
              "WITH next AS (SELECT id FROM tasks WHERE state = 'queued' AND program = ? AND {} AND "
              "(not_before IS NULL OR not_before <= now()) ORDER BY priority, coalesce(parent, id), id LIMIT 1 "
              "FOR UPDATE SKIP LOCKED), claimed AS (UPDATE tasks t SET state = 'running', "
              "attempt = t.attempt + 1, worker = ?, leased_until = now() + ? * interval '1 s', renewed_at = now() FROM "
              "next WHERE t.id = next.id RETURNING t.id, t.attempt, t.kind, t.key, t.payload, t.failures, t.kills, "
              "t.parent), "
              "logged AS (INSERT INTO task_log (task_id, attempt, event, worker) "
              "SELECT id, attempt, 'claimed', ? FROM claimed) SELECT * FROM claimed",
              IsChosen(options_.choice)),
          options_.program, options_.worker, static_cast<double>(options_.lease.count()), options_.worker));
  std::optional<Task> task;
  if (row.Next()) {
    task = {.id = row.Integer(0),
            .attempt = row.Integer(1),
            .kind = row.Text(2),
            .key = row.Text(3),
            .payload = row.Text(4),
            .failures = row.Integer(5),
            .kills = row.Integer(6),
            .parent = row.OptionalInteger(7)};
    return task;
  }
  // A worker that ended a part may have died before it woke the task.
  VICTORIOUS_RETURN_IF_ERROR(Wake(std::nullopt));
  return task;
}

Expected<bool> TaskQueue::Renew(const Task& task, bool has_progress) {
  VICTORIOUS_ASSIGN_OR_RETURN(
      Result renewed,
      connection_->Write(
          "UPDATE tasks SET leased_until = now() + ? * interval '1 s', renewed_at = now(), failures = failures * ?, "
          "kills = kills * ? WHERE id = ? AND attempt = ? AND state = 'running' RETURNING is_ending::int::bigint",
          static_cast<double>(options_.lease.count()), has_progress ? 0 : 1, has_progress ? 0 : 1, task.id,
          task.attempt));
  if (!renewed.Next()) return LostLease(task);
  return renewed.Integer(0) == 0;
}

Expected<std::int64_t> TaskQueue::Progress(const std::string& video) {
  VICTORIOUS_ASSIGN_OR_RETURN(
      Result row, connection_->Query("SELECT coalesce(sum(s.next_frame), 0)::bigint FROM videos v JOIN searches s ON "
                                     "s.video_id = v.id WHERE v.name = ?",
                                     video));
  return row.Next() ? row.Integer(0) : 0;
}

Status TaskQueue::Complete(const Task& task) {
  VICTORIOUS_RETURN_IF_ERROR(EndLease(task, WorkState::kDone, std::nullopt, "done"));
  return WakeParent(task);
}

Status TaskQueue::Release(const Task& task, std::chrono::seconds delay, const std::optional<std::string>& reason) {
  return EndLease(task, WorkState::kQueued, reason, "released", delay);
}

Status TaskQueue::End(std::int64_t task) {
  VICTORIOUS_ASSIGN_OR_RETURN(
      const Result ended, connection_->Write("UPDATE tasks SET is_ending = state = 'running', "
                                             "state = CASE WHEN state = 'running' THEN state ELSE 'done' END "
                                             "WHERE id = ? AND is_lasting AND state IN ('queued', 'running', 'failed')",
                                             task));
  return {};
}

Status TaskQueue::Reject(const Task& task, const std::string& reason) {
  VICTORIOUS_RETURN_IF_ERROR(EndLease(task, WorkState::kFailed, reason, "failed"));
  return WakeParent(task);
}

Status TaskQueue::Fail(const Task& task, const std::string& reason, FailureKind kind) {
  const int kill = kind == FailureKind::kKilled ? 1 : 0;
  VICTORIOUS_ASSIGN_OR_RETURN(
      const Result ended,
      connection_->Write("WITH counted AS (SELECT ?::bigint AS kill), ended AS (UPDATE tasks SET "
                         "failures = failures + 1 - kill, kills = kills + kill, state = CASE WHEN is_ending THEN "
                         "'done' WHEN failures + 1 - kill < ? AND kills + kill < ? THEN 'queued' ELSE 'failed' END, "
                         "is_ending = false, reason = ?, is_fatal = ?::bigint <> 0, worker = NULL, "
                         "leased_until = NULL, "
                         "not_before = now() + ? * power(4, failures) * interval '1 s' "
                         "FROM counted WHERE id = ? AND attempt = ? AND state = 'running' RETURNING id, attempt) "
                         "INSERT INTO task_log (task_id, attempt, event, worker) "
                         "SELECT id, attempt, 'failed', ? FROM ended",
                         kill, kMaxAttempts, kMaxKills, reason, kind == FailureKind::kError ? 0 : 1,
                         static_cast<double>(options_.retry_delay.count()), task.id, task.attempt, options_.worker));
  if (ended.Changes() != 1) return LostLease(task);
  return WakeParent(task);
}

Status TaskQueue::Wait(const Task& task, std::span<const NewTask> parts) {
  VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_, Exclusion::kNothing));
  VICTORIOUS_ASSIGN_OR_RETURN(
      Result ended,
      connection_->Query(
          "WITH ended AS (UPDATE tasks SET state = 'waiting', reason = NULL, worker = NULL, "
          "leased_until = NULL, failures = 0, kills = 0, is_fatal = false WHERE id = ? AND attempt = ? AND "
          "state = 'running' RETURNING id, attempt, priority), logged AS ("
          "INSERT INTO task_log (task_id, attempt, event, worker) "
          "SELECT id, attempt, 'released', ? FROM ended) SELECT priority FROM ended",
          task.id, task.attempt, options_.worker));
  if (!ended.Next()) return LostLease(task);
  const std::int64_t priority = ended.Integer(0);
  for (const NewTask& part : parts) {
    VICTORIOUS_RETURN_IF_ERROR(connection_->Query(
        "INSERT INTO tasks (kind, key, priority, payload, program, parent) VALUES (?, ?, ?, ?, ?, ?) "
        "ON CONFLICT (kind, key) DO UPDATE SET state = 'queued', failures = 0, kills = 0, is_fatal = false, "
        "reason = NULL, not_before = NULL, payload = excluded.payload, priority = excluded.priority, program = "
        "excluded.program, "
        "parent = excluded.parent WHERE tasks.state IN ('done', 'failed')",
        part.kind, part.key, priority, part.payload, part.program, task.id));
  }
  VICTORIOUS_RETURN_IF_ERROR(transaction.Commit());
  return Wake(task.id);  // all parts may have ended before
}

Expected<std::vector<TaskRecord>> TaskQueue::FatalParts(const Task& task) {
  VICTORIOUS_ASSIGN_OR_RETURN(
      Result rows,
      connection_->Query(
          fmt::format("{}WHERE parent = ? AND state = 'failed' AND is_fatal ORDER BY id", kSelectRecords), task.id));
  std::vector<TaskRecord> parts;
  while (rows.Next()) parts.push_back(ReadTaskRecord(rows));
  return parts;
}

Status TaskQueue::CloseFailed(std::int64_t task) {
  VICTORIOUS_ASSIGN_OR_RETURN(
      const Result closed,
      connection_->Write("UPDATE tasks SET state = 'done' WHERE id = ? AND state = 'failed'", task));
  return {};
}

Status TaskQueue::EndLease(const Task& task, WorkState state, const std::optional<std::string>& reason,
                           std::string_view event, std::chrono::seconds delay) {
  VICTORIOUS_ASSIGN_OR_RETURN(
      const Result ended,
      connection_->Write("WITH ended AS (UPDATE tasks SET state = CASE WHEN is_ending THEN 'done' ELSE ? END, "
                         "is_ending = false, reason = ?, worker = NULL, leased_until = NULL, "
                         "not_before = now() + ? * interval '1 s' "
                         "WHERE id = ? AND attempt = ? AND state = 'running' RETURNING id, attempt) "
                         "INSERT INTO task_log (task_id, attempt, event, worker) SELECT id, attempt, ?, ? FROM ended",
                         ToText(state), reason, static_cast<double>(delay.count()), task.id, task.attempt, event,
                         options_.worker));
  if (ended.Changes() != 1) return LostLease(task);
  return {};
}

std::unexpected<Error> TaskQueue::LostLease(const Task& task) const {
  return victorious::Fail(
      ErrorCode::kConflict,
      fmt::format("{}: attempt {} of task {} does not run any more: its lease was not renewed for {} s, and "
                  "another worker may do it",
                  connection_->name(), task.attempt, task.id, options_.lease.count()));
}

Status TaskQueue::Excuse(const Task& task) {
  const Status released = Release(task);
  if (released || released.error().code != ErrorCode::kConflict) return released;
  VICTORIOUS_ASSIGN_OR_RETURN(
      const Result excused,
      connection_->Write(
          "UPDATE tasks t SET kills = greatest(kills - 1, 0), "
          "is_fatal = is_fatal AND (attempt <> ? OR state = 'running'), "
          "state = CASE WHEN state = 'failed' AND attempt = ? THEN 'queued' ELSE state END "
          "WHERE id = ? AND state IN ('queued', 'running', 'failed') AND EXISTS (SELECT FROM task_log l WHERE "
          "l.task_id = t.id AND l.attempt = ? AND l.event = 'lost')",
          task.attempt, task.attempt, task.id, task.attempt));
  return {};
}

Status TaskQueue::ReleaseOwn() {
  VICTORIOUS_ASSIGN_OR_RETURN(
      const Result released,
      connection_->Write(
          "WITH ended AS (UPDATE tasks SET state = 'queued', worker = NULL, leased_until = NULL WHERE "
          "state = 'running' AND worker = ? RETURNING id, attempt) INSERT INTO task_log (task_id, attempt, event, "
          "worker) SELECT id, attempt, 'released', ? FROM ended",
          options_.worker, options_.worker));
  return {};
}

Expected<TaskCounts> TaskQueue::Count() { return Count(false); }

Expected<TaskCounts> TaskQueue::CountParts() { return Count(true); }

Expected<TaskCounts> TaskQueue::Count(bool of_parts) {
  VICTORIOUS_ASSIGN_OR_RETURN(
      Result row, connection_->Query(fmt::format(
                      "SELECT count(*) FILTER (WHERE state = 'queued'), count(*) FILTER (WHERE state = 'waiting'), "
                      "count(*) FILTER (WHERE state = 'running'), count(*) FILTER (WHERE state = 'done'), "
                      "count(*) FILTER (WHERE state = 'failed') FROM tasks WHERE NOT is_lasting AND parent IS {}NULL",
                      of_parts ? "NOT " : "")));
  if (!row.Next()) return TaskCounts{};
  return TaskCounts{row.Integer(0), row.Integer(1), row.Integer(2), row.Integer(3), row.Integer(4)};
}

Expected<std::vector<TaskRecord>> TaskQueue::ListLasting(LastingTasks which) {
  VICTORIOUS_ASSIGN_OR_RETURN(
      Result rows, connection_->Query(fmt::format("{}WHERE is_lasting{} ORDER BY id", kSelectRecords,
                                                  which == LastingTasks::kOpen ? " AND state <> 'done'" : "")));
  std::vector<TaskRecord> tasks;
  while (rows.Next()) tasks.push_back(ReadTaskRecord(rows));
  return tasks;
}

Expected<std::vector<TaskRecord>> TaskQueue::List(std::int64_t limit) {
  std::vector<TaskRecord> tasks;
  for (const WorkState state : {WorkState::kRunning, WorkState::kFailed}) {
    VICTORIOUS_ASSIGN_OR_RETURN(
        Result rows,
        connection_->Query(fmt::format("{}WHERE state = ? AND NOT is_lasting ORDER BY id LIMIT ?", kSelectRecords),
                           ToText(state), limit));
    while (rows.Next()) tasks.push_back(ReadTaskRecord(rows));
  }
  return tasks;
}

Expected<std::vector<TaskRecord>> TaskQueue::FindOpen(std::string_view kind, std::span<const std::string> words) {
  VICTORIOUS_ASSIGN_OR_RETURN(
      Result rows, connection_->Query(fmt::format("{}WHERE kind = ? AND state IN ('queued', 'waiting', 'running') AND "
                                                  "split_part(key, ' ', 1) = ANY (?::text::text[]) ORDER BY id",
                                                  kSelectRecords),
                                      kind, fmt::format("{{{}}}", fmt::join(words, ","))));
  std::vector<TaskRecord> tasks;
  while (rows.Next()) tasks.push_back(ReadTaskRecord(rows));
  return tasks;
}

Expected<bool> TaskQueue::HasOpenTasks() {
  const std::string_view chosen = IsChosen(options_.choice);
  VICTORIOUS_ASSIGN_OR_RETURN(
      Result row,
      connection_->Query(fmt::format("SELECT EXISTS (SELECT FROM tasks WHERE state = 'queued' AND program = ? AND {}) "
                                     "OR EXISTS (SELECT FROM tasks WHERE state = 'running' AND program = ? AND {}) OR "
                                     "EXISTS (SELECT FROM tasks WHERE state = 'waiting' AND program = ? AND {})",
                                     chosen, chosen, chosen),
                         options_.program, options_.program, options_.program));
  return row.Next() && row.Integer(0) != 0;
}

Expected<std::optional<double>> TaskQueue::MeanSeconds(bool of_parts) {
  VICTORIOUS_ASSIGN_OR_RETURN(
      Result row,
      connection_->Query(fmt::format(
          "SELECT avg(extract(epoch FROM d.at - c.at))::double precision FROM (SELECT l.task_id, l.attempt, l.at FROM "
          "task_log l JOIN tasks t ON t.id = l.task_id WHERE l.event = 'done' AND {} ORDER BY l.at DESC LIMIT 1000) d "
          "JOIN task_log c USING (task_id, attempt) WHERE c.event = 'claimed'",
          of_parts
              ? "t.parent IS NOT NULL"
              : "NOT t.is_lasting AND t.parent IS NULL AND NOT EXISTS (SELECT FROM tasks p WHERE p.parent = t.id)")));
  return row.Next() ? row.OptionalReal(0) : std::nullopt;
}

}  // namespace victorious::postgres

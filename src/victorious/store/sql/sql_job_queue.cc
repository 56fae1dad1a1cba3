// JobQueue in an index. Each step is one transaction that excludes all others that write to the queue.
#include <string>
#include <utility>

#include <fmt/format.h>

#include "victorious/base/one_line.h"
#include "victorious/store/job_queue.h"
#include "victorious/store/sql/audit.h"
#include "victorious/store/sql/database.h"

namespace victorious::sql {
namespace {

constexpr std::string_view kSelectJobs =
    "SELECT id, kind, input, state, created_utc_us, started_utc_us, ended_utc_us, owner, attempts, cancel_asked, done, "
    "total, unit, message, behind_s FROM jobs ";

Expected<JobRecord> ReadJob(const Row& row, std::string_view name) {
  const auto kind = FromText(kJobKindTexts, row.Text(1));
  if (!kind) {
    return Fail(
        ErrorCode::kUnsupported,
        fmt::format("{}: job {} is of the kind \"{}\", which this program does not know: a newer version wrote it",
                    name, row.Integer(0), OneLine(row.Text(1))));
  }
  const auto state = FromText(kWorkStateTexts, row.Text(3));
  if (!state) return std::unexpected(DamagedIndex(name, fmt::format("a job in the state \"{}\"", row.Text(3))));
  return JobRecord{.id = row.Integer(0),
                   .kind = *kind,
                   .input_json = row.Text(2),
                   .state = *state,
                   .created_utc_us = row.Integer(4),
                   .started_utc_us = row.OptionalInteger(5),
                   .ended_utc_us = row.OptionalInteger(6),
                   .worker = row.Text(7),
                   .attempts = static_cast<int>(row.Integer(8)),
                   .cancel_asked = row.Integer(9) != 0,
                   .progress = {.done = row.Integer(10),
                                .total = row.OptionalInteger(11),
                                .unit = row.Text(12),
                                .message = row.Text(13),
                                .behind_s = row.OptionalReal(14)}};
}

class SqlJobQueue final : public JobQueue {
 public:
  explicit SqlJobQueue(std::unique_ptr<Database> database) : database_(std::move(database)) {}

  Expected<JobRecord> Submit(const NewJob& job) override {
    VICTORIOUS_ASSIGN_OR_RETURN(Change change, Change::Begin(*database_));
    VICTORIOUS_ASSIGN_OR_RETURN(JobRecord record, Insert(job));
    VICTORIOUS_RETURN_IF_ERROR(change.Commit());
    return record;
  }

  Expected<SubmittedJob> SubmitOnce(const NewJob& job) override {
    VICTORIOUS_ASSIGN_OR_RETURN(Change change, Change::Begin(*database_));
    VICTORIOUS_ASSIGN_OR_RETURN(std::optional<JobRecord> open, FindOpen(job.kind, job.input_json));
    if (open) return SubmittedJob{.job = *std::move(open), .is_new = false};
    VICTORIOUS_ASSIGN_OR_RETURN(JobRecord record, Insert(job));
    VICTORIOUS_RETURN_IF_ERROR(change.Commit());
    return SubmittedJob{.job = std::move(record), .is_new = true};
  }

  Expected<std::optional<JobRecord>> Claim(const std::string& worker, std::span<const JobKind> kinds,
                                           std::int64_t now_us, std::int64_t lease_us) override {
    std::string texts;
    for (const JobKind kind : kinds) texts += fmt::format("{}'{}'", texts.empty() ? "" : ", ", ToText(kind));
    VICTORIOUS_ASSIGN_OR_RETURN(Change change, Change::Begin(*database_));
    VICTORIOUS_RETURN_IF_ERROR(EndLostLeases(now_us));
    // Somebody waits for a copy before the page plays a video, and it takes minutes where a search takes hours.
    VICTORIOUS_ASSIGN_OR_RETURN(
        const std::int64_t id,
        database_->ReadInteger(fmt::format("SELECT id FROM jobs WHERE (state = 'queued' OR (state = 'running' AND "
                                           "lease_utc_us < ?)) AND kind IN ({}) ORDER BY kind <> ?, id LIMIT 1",
                                           texts),
                               ValueList(now_us, ToText(JobKind::kCopy))));
    std::optional<JobRecord> claimed;
    if (id != 0) {
      VICTORIOUS_RETURN_IF_ERROR(
          database_->Write("UPDATE jobs SET state = 'running', owner = ?, lease_utc_us = ?, started_utc_us = ?, "
                           "attempts = attempts + 1, "
                           "done = 0, total = NULL, unit = '', message = '', behind_s = NULL WHERE id = ?",
                           ValueList(worker, now_us + lease_us, now_us, id)));
      VICTORIOUS_ASSIGN_OR_RETURN(claimed, Find(id));
    }
    VICTORIOUS_RETURN_IF_ERROR(change.Commit());
    return claimed;
  }

  Expected<bool> Renew(std::int64_t job, const std::string& worker, std::int64_t now_us, std::int64_t lease_us,
                       const JobProgress& progress) override {
    // A server that is killed for other reasons takes its jobs along, but they come further each time.
    VICTORIOUS_RETURN_IF_ERROR(WriteOwned(
        "UPDATE jobs SET lease_utc_us = ?, done = ?, total = ?, unit = ?, message = ?, behind_s = ?, "
        "attempts = CASE WHEN furthest < ? THEN 1 ELSE attempts END, "
        "furthest = CASE WHEN furthest < ? THEN ? ELSE furthest END WHERE id = ? AND owner = ? AND state = 'running'",
        ValueList(now_us + lease_us, progress.done, progress.total, progress.unit, progress.message, progress.behind_s,
                  progress.done, progress.done, progress.done, job, worker),
        job));
    VICTORIOUS_ASSIGN_OR_RETURN(const JobRecord record, Get(job));
    return !record.cancel_asked;
  }

  Status Complete(std::int64_t job, const std::string& worker, const std::string& message,
                  std::int64_t now_us) override {
    return End(job, worker, WorkState::kDone, message, now_us);
  }

  Status Fail(std::int64_t job, const std::string& worker, const std::string& message, std::int64_t now_us) override {
    return End(job, worker, WorkState::kFailed, message, now_us);
  }

  Status EndCancelled(std::int64_t job, const std::string& worker, std::int64_t now_us) override {
    return End(job, worker, WorkState::kCancelled, "", now_us);
  }

  Status Release(std::int64_t job, const std::string& worker) override {
    return WriteOwned(
        "UPDATE jobs SET state = 'queued', owner = NULL, lease_utc_us = NULL, attempts = attempts - 1 WHERE id = ? AND "
        "owner = ? AND state = 'running'",
        ValueList(job, worker), job);
  }

  Expected<JobRecord> Cancel(std::int64_t job, std::int64_t now_us, const std::string& actor) override {
    VICTORIOUS_ASSIGN_OR_RETURN(Change change, Change::Begin(*database_));
    VICTORIOUS_RETURN_IF_ERROR(
        database_->Write("UPDATE jobs SET state = 'cancelled', ended_utc_us = ? WHERE id = ? AND state = 'queued'",
                         ValueList(now_us, job)));
    VICTORIOUS_RETURN_IF_ERROR(
        database_->Write("UPDATE jobs SET cancel_asked = 1 WHERE id = ? AND state = 'running'", ValueList(job)));
    VICTORIOUS_ASSIGN_OR_RETURN(JobRecord record, Get(job));
    VICTORIOUS_RETURN_IF_ERROR(Log("cancel_job", job, "", now_us, actor));
    VICTORIOUS_RETURN_IF_ERROR(change.Commit());
    return record;
  }

  Expected<JobRecord> Retry(std::int64_t job, std::int64_t now_us, const std::string& actor) override {
    VICTORIOUS_ASSIGN_OR_RETURN(Change change, Change::Begin(*database_));
    VICTORIOUS_ASSIGN_OR_RETURN(JobRecord record, Get(job));
    if (record.state != WorkState::kFailed && record.state != WorkState::kCancelled) {
      return Refuse(record, "only a job that has failed or was cancelled can be tried again");
    }
    VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<JobRecord> open, FindOpen(record.kind, record.input_json));
    if (open) return Refuse(record, fmt::format("job {} does the same already", open->id));
    VICTORIOUS_RETURN_IF_ERROR(database_->Write(
        "UPDATE jobs SET state = 'queued', started_utc_us = NULL, ended_utc_us = NULL, attempts = 0, furthest = 0, "
        "cancel_asked = 0, done = 0, total = NULL, unit = '', message = '', behind_s = NULL WHERE id = ?",
        ValueList(job)));
    VICTORIOUS_RETURN_IF_ERROR(Log("retry_job", job, "", now_us, actor));
    VICTORIOUS_ASSIGN_OR_RETURN(record, Get(job));
    VICTORIOUS_RETURN_IF_ERROR(change.Commit());
    return record;
  }

  Status Remove(std::int64_t job, std::int64_t now_us, const std::string& actor) override {
    VICTORIOUS_ASSIGN_OR_RETURN(Change change, Change::Begin(*database_));
    VICTORIOUS_ASSIGN_OR_RETURN(const JobRecord record, Get(job));
    if (record.state == WorkState::kQueued || record.state == WorkState::kRunning) {
      return Refuse(record, "only a job that has ended can be removed; cancel it first");
    }
    VICTORIOUS_RETURN_IF_ERROR(database_->Write("DELETE FROM jobs WHERE id = ?", ValueList(job)));
    VICTORIOUS_RETURN_IF_ERROR(Log("remove_job", job, "", now_us, actor));
    return change.Commit();
  }

  Expected<std::optional<JobRecord>> Find(std::int64_t job) override { return FindOne("WHERE id = ?", ValueList(job)); }

  Expected<std::vector<JobRecord>> List(std::int64_t limit) override {
    std::vector<JobRecord> jobs;
    const auto add = [&](std::string_view part, const ValueList& values) {
      return database_->Visit(fmt::format("{}{}", kSelectJobs, part), values, RowCount::kFew,
                              [&](const Row& row) -> Expected<bool> {
                                if (!FromText(kJobKindTexts, row.Text(1))) return true;
                                VICTORIOUS_ASSIGN_OR_RETURN(JobRecord record, ReadJob(row, database_->name()));
                                jobs.push_back(std::move(record));
                                return true;
                              });
    };
    VICTORIOUS_RETURN_IF_ERROR(add("WHERE state IN ('queued', 'running') ORDER BY id LIMIT 1000", ValueList()));
    VICTORIOUS_RETURN_IF_ERROR(
        add("WHERE state IN ('done', 'failed', 'cancelled') ORDER BY id DESC LIMIT ?", ValueList(limit)));
    return jobs;
  }

  Expected<std::int64_t> CountOpen() override {
    return database_->ReadInteger("SELECT count(*) FROM jobs WHERE state IN ('queued', 'running')", ValueList());
  }

 private:
  // In a transaction: the job and its entry of the log.
  Expected<JobRecord> Insert(const NewJob& job) {
    VICTORIOUS_ASSIGN_OR_RETURN(
        const std::int64_t id,
        database_->ReadInteger("INSERT INTO jobs (kind, input, state, created_utc_us) VALUES (?, ?, ?, ?) RETURNING id",
                               ValueList(ToText(job.kind), job.input_json, ToText(WorkState::kQueued), job.now_us)));
    VICTORIOUS_RETURN_IF_ERROR(Log("job", id, job.logged.empty() ? job.input_json : job.logged, job.now_us, job.actor));
    return Get(id);
  }

  Status Log(std::string action, std::int64_t job, std::string detail, std::int64_t now_us, std::string actor) {
    return AddAudit(*database_, {.time_utc_us = now_us,
                                 .actor = std::move(actor),
                                 .action = std::move(action),
                                 .subject = fmt::format("job {}", job),
                                 .detail = std::move(detail)});
  }

  Expected<std::optional<JobRecord>> FindOne(std::string_view where, const ValueList& values) {
    return database_->ReadOne(fmt::format("{}{}", kSelectJobs, where), values,
                              [&](const Row& row) { return ReadJob(row, database_->name()); });
  }

  // The open job of this kind and input.
  Expected<std::optional<JobRecord>> FindOpen(JobKind kind, const std::string& input_json) {
    return FindOne("WHERE state IN ('queued', 'running') AND kind = ? AND input = ? ORDER BY id LIMIT 1",
                   ValueList(ToText(kind), input_json));
  }

  // Without the name of the index: users of the server see it.
  static std::unexpected<Error> Refuse(const JobRecord& job, std::string_view why) {
    return victorious::Fail(ErrorCode::kConflict, fmt::format("Job {} is {}: {}", job.id, ToText(job.state), why));
  }

  Expected<JobRecord> Get(std::int64_t job) {
    VICTORIOUS_ASSIGN_OR_RETURN(std::optional<JobRecord> record, Find(job));
    if (record) return *std::move(record);
    return victorious::Fail(ErrorCode::kNotFound, fmt::format("{}: there is no job {}", database_->name(), job));
  }

  Status End(std::int64_t job, const std::string& worker, WorkState state, const std::string& message,
             std::int64_t now_us) {
    return WriteOwned(
        "UPDATE jobs SET state = ?, message = ?, ended_utc_us = ?, owner = NULL, lease_utc_us = NULL WHERE id = ? AND "
        "owner = ? AND state = 'running'",
        ValueList(ToText(state), message, now_us, job, worker), job);
  }

  Status WriteOwned(const std::string& sql, const ValueList& values, std::int64_t job) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t changed, database_->Write(sql, values));
    if (changed == 1) return {};
    return victorious::Fail(ErrorCode::kConflict, fmt::format("{}: job {} belongs to another worker now, or has ended",
                                                              database_->name(), job));
  }

  // Ends jobs whose lease was lost and that are not to be tried again.
  Status EndLostLeases(std::int64_t now_us) {
    const std::string reason = fmt::format(
        "its process was killed {} times at the same place: see the log of the server, then start the job again",
        kMaxJobAttempts);
    const auto ended = database_->Write(
        "UPDATE jobs SET state = CASE WHEN cancel_asked = 1 THEN 'cancelled' ELSE 'failed' END, "
        "message = CASE WHEN cancel_asked = 1 THEN message ELSE ? END, ended_utc_us = ?, owner = NULL, "
        "lease_utc_us = NULL WHERE state = 'running' AND lease_utc_us < ? AND (cancel_asked = 1 OR attempts >= ?)",
        ValueList(reason, now_us, now_us, kMaxJobAttempts));
    if (!ended) return std::unexpected(ended.error());
    return {};
  }

  std::unique_ptr<Database> database_;
};

}  // namespace
}  // namespace victorious::sql

namespace victorious {

Expected<std::unique_ptr<JobQueue>> OpenJobQueue(const std::string& name) {
  VICTORIOUS_ASSIGN_OR_RETURN(auto database, sql::OpenDatabase(name, StoreMode::kCreate));
  return std::make_unique<sql::SqlJobQueue>(std::move(database));
}

}  // namespace victorious

// JobQueue in the SQLite file of an index. Each step is one transaction that takes the write lock first.
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/base/json.h"
#include "victorious/base/one_line.h"
#include "victorious/store/job_queue.h"
#include "victorious/store/sqlite/open_database.h"

namespace victorious::sqlite {
namespace {

constexpr std::string_view kSelect =
    "SELECT id, kind, input, state, created_utc_us, started_utc_us, ended_utc_us, owner, attempts, cancel_asked, done, "
    "total, unit, message FROM jobs ";

Expected<JobRecord> ReadJob(const Statement& row, std::string_view name) {
  const auto kind = FromText(kJobKindTexts, row.Text(1));
  if (!kind) {
    return Fail(
        ErrorCode::kUnsupported,
        fmt::format("{}: job {} is of the kind \"{}\", which this program does not know: a newer version wrote it",
                    name, row.Integer(0), OneLine(row.Text(1))));
  }
  const auto state = FromText(kWorkStateTexts, row.Text(3));
  if (!state) return std::unexpected(DamagedIndex(name, fmt::format("a job in the state \"{}\"", row.Text(3))));
  return JobRecord{
      .id = row.Integer(0),
      .kind = *kind,
      .input_json = row.Text(2),
      .state = *state,
      .created_utc_us = row.Integer(4),
      .started_utc_us = row.OptionalInteger(5),
      .ended_utc_us = row.OptionalInteger(6),
      .worker = row.Text(7),
      .attempts = static_cast<int>(row.Integer(8)),
      .cancel_asked = row.Integer(9) != 0,
      .progress = {
          .done = row.Integer(10), .total = row.OptionalInteger(11), .unit = row.Text(12), .message = row.Text(13)}};
}

class SqliteJobQueue final : public JobQueue {
 public:
  explicit SqliteJobQueue(std::unique_ptr<Connection> connection) : connection_(std::move(connection)) {}

  Expected<JobRecord> Submit(const NewJob& job) override {
    VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_));
    VICTORIOUS_ASSIGN_OR_RETURN(JobRecord record, Insert(job));
    VICTORIOUS_RETURN_IF_ERROR(transaction.Commit());
    return record;
  }

  Expected<SubmittedJob> SubmitOnce(const NewJob& job) override {
    VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_));
    {
      VICTORIOUS_ASSIGN_OR_RETURN(
          Statement select,
          connection_->Prepare(std::string(kSelect) + "WHERE state IN ('queued', 'running') AND kind = ? AND input = ? "
                                                      "ORDER BY id LIMIT 1"));
      VICTORIOUS_ASSIGN_OR_RETURN(const bool found, select.Bind(ToText(job.kind), job.input_json).Step());
      if (found) {
        VICTORIOUS_ASSIGN_OR_RETURN(JobRecord record, ReadJob(select, connection_->name()));
        return SubmittedJob{.job = std::move(record), .is_new = false};
      }
    }
    VICTORIOUS_ASSIGN_OR_RETURN(JobRecord record, Insert(job));
    VICTORIOUS_RETURN_IF_ERROR(transaction.Commit());
    return SubmittedJob{.job = std::move(record), .is_new = true};
  }

  Expected<std::optional<JobRecord>> Claim(const std::string& worker, std::span<const JobKind> kinds,
                                           std::int64_t now_us, std::int64_t lease_us) override {
    auto texts = nlohmann::json::array();
    for (const JobKind kind : kinds) texts.push_back(ToText(kind));
    VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_));
    VICTORIOUS_RETURN_IF_ERROR(EndLostLeases(now_us));
    std::int64_t id = 0;
    {
      // Somebody waits for a copy before the page plays a video, and it takes minutes where a search takes hours.
      VICTORIOUS_ASSIGN_OR_RETURN(
          Statement select,
          connection_->Prepare("SELECT id FROM jobs WHERE (state = 'queued' OR (state = 'running' AND lease_utc_us < "
                               "?)) AND kind IN (SELECT value FROM json_each(?)) ORDER BY kind != ?, id LIMIT 1"));
      VICTORIOUS_ASSIGN_OR_RETURN(const bool found,
                                  select.Bind(now_us, DumpJson(texts), ToText(JobKind::kCopy)).Step());
      if (found) id = select.Integer(0);
    }
    std::optional<JobRecord> claimed;
    if (id != 0) {
      {
        VICTORIOUS_ASSIGN_OR_RETURN(
            Statement claim,
            connection_->Prepare("UPDATE jobs SET state = 'running', owner = ?, lease_utc_us = ?, started_utc_us = ?, "
                                 "attempts = attempts + 1, done = 0, total = NULL, unit = '', message = '' "
                                 "WHERE id = ?"));
        VICTORIOUS_RETURN_IF_ERROR(claim.Bind(worker, now_us + lease_us, now_us, id).Run());
      }
      VICTORIOUS_ASSIGN_OR_RETURN(claimed, Find(id));
    }
    VICTORIOUS_RETURN_IF_ERROR(transaction.Commit());
    return claimed;
  }

  Expected<bool> Renew(std::int64_t job, const std::string& worker, std::int64_t now_us, std::int64_t lease_us,
                       const JobProgress& progress) override {
    {
      VICTORIOUS_ASSIGN_OR_RETURN(
          Statement renew, connection_->Prepare("UPDATE jobs SET lease_utc_us = ?, done = ?, total = ?, unit = ?, "
                                                "message = ? WHERE id = ? AND owner = ? AND state = 'running'"));
      renew.Bind(now_us + lease_us, progress.done, progress.total, progress.unit, progress.message, job, worker);
      VICTORIOUS_RETURN_IF_ERROR(RunOwned(renew, job));
    }
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
    VICTORIOUS_ASSIGN_OR_RETURN(
        Statement release,
        connection_->Prepare("UPDATE jobs SET state = 'queued', owner = NULL, lease_utc_us = NULL, attempts = attempts "
                             "- 1 WHERE id = ? AND owner = ? AND state = 'running'"));
    release.Bind(job, worker);
    return RunOwned(release, job);
  }

  Expected<JobRecord> Cancel(std::int64_t job, std::int64_t now_us, const std::string& actor) override {
    VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_));
    for (const std::string_view sql :
         {"UPDATE jobs SET state = 'cancelled', ended_utc_us = ?2 WHERE id = ?1 AND state = 'queued'",
          "UPDATE jobs SET cancel_asked = 1 WHERE id = ?1 AND state = 'running' AND ?2 IS NOT NULL"}) {
      VICTORIOUS_ASSIGN_OR_RETURN(Statement update, connection_->Prepare(sql));
      VICTORIOUS_RETURN_IF_ERROR(update.Bind(job, now_us).Run());
    }
    VICTORIOUS_ASSIGN_OR_RETURN(JobRecord record, Get(job));
    VICTORIOUS_RETURN_IF_ERROR(Log("cancel_job", job, "", now_us, actor));
    VICTORIOUS_RETURN_IF_ERROR(transaction.Commit());
    return record;
  }

  Expected<std::optional<JobRecord>> Find(std::int64_t job) override {
    VICTORIOUS_ASSIGN_OR_RETURN(Statement select, connection_->Prepare(std::string(kSelect) + "WHERE id = ?"));
    VICTORIOUS_ASSIGN_OR_RETURN(const bool found, select.Bind(job).Step());
    if (!found) return std::nullopt;
    VICTORIOUS_ASSIGN_OR_RETURN(JobRecord record, ReadJob(select, connection_->name()));
    return record;
  }

  Expected<std::vector<JobRecord>> List(std::int64_t limit) override {
    std::vector<JobRecord> jobs;
    for (const std::string_view part : {"WHERE state IN ('queued', 'running') ORDER BY id LIMIT 1000",
                                        "WHERE state IN ('done', 'failed', 'cancelled') ORDER BY id DESC LIMIT ?"}) {
      VICTORIOUS_ASSIGN_OR_RETURN(Statement select, connection_->Prepare(std::string(kSelect) + std::string(part)));
      if (part.ends_with('?')) select.Bind(limit);
      while (true) {
        VICTORIOUS_ASSIGN_OR_RETURN(const bool has_row, select.Step());
        if (!has_row) break;
        if (!FromText(kJobKindTexts, select.Text(1))) continue;
        VICTORIOUS_ASSIGN_OR_RETURN(JobRecord record, ReadJob(select, connection_->name()));
        jobs.push_back(std::move(record));
      }
    }
    return jobs;
  }

  Expected<std::int64_t> CountOpen() override {
    VICTORIOUS_ASSIGN_OR_RETURN(Statement select,
                                connection_->Prepare("SELECT count(*) FROM jobs WHERE state IN ('queued', 'running')"));
    VICTORIOUS_RETURN_IF_ERROR(select.Step());
    return select.Integer(0);
  }

 private:
  // In a transaction: the job and its entry of the log.
  Expected<JobRecord> Insert(const NewJob& job) {
    {
      VICTORIOUS_ASSIGN_OR_RETURN(Statement insert,
                                  connection_->Prepare("INSERT INTO jobs (kind, input, state, created_utc_us) "
                                                       "VALUES (?, ?, ?, ?)"));
      VICTORIOUS_RETURN_IF_ERROR(
          insert.Bind(ToText(job.kind), job.input_json, ToText(WorkState::kQueued), job.now_us).Run());
    }
    const std::int64_t id = connection_->LastInsertId();
    VICTORIOUS_RETURN_IF_ERROR(Log("job", id, job.logged.empty() ? job.input_json : job.logged, job.now_us, job.actor));
    return Get(id);
  }

  Status Log(std::string_view action, std::int64_t job, const std::string& detail, std::int64_t now_us,
             const std::string& actor) {
    VICTORIOUS_ASSIGN_OR_RETURN(
        Statement insert,
        connection_->Prepare("INSERT INTO audit (time_utc_us, actor, action, subject, detail) VALUES (?, ?, ?, ?, ?)"));
    return insert.Bind(now_us, actor, action, fmt::format("job {}", job), detail).Run();
  }

  Expected<JobRecord> Get(std::int64_t job) {
    VICTORIOUS_ASSIGN_OR_RETURN(std::optional<JobRecord> record, Find(job));
    if (record) return *std::move(record);
    return victorious::Fail(ErrorCode::kNotFound, fmt::format("{}: there is no job {}", connection_->name(), job));
  }

  Status End(std::int64_t job, const std::string& worker, WorkState state, const std::string& message,
             std::int64_t now_us) {
    VICTORIOUS_ASSIGN_OR_RETURN(
        Statement end, connection_->Prepare("UPDATE jobs SET state = ?, message = ?, ended_utc_us = ?, owner = NULL, "
                                            "lease_utc_us = NULL WHERE id = ? AND owner = ? AND state = 'running'"));
    end.Bind(ToText(state), message, now_us, job, worker);
    return RunOwned(end, job);
  }

  Status RunOwned(Statement& statement, std::int64_t job) {
    VICTORIOUS_RETURN_IF_ERROR(statement.Run());
    if (connection_->Changes() == 1) return {};
    return victorious::Fail(ErrorCode::kConflict, fmt::format("{}: job {} belongs to another worker now, or has ended",
                                                              connection_->name(), job));
  }

  // Ends jobs whose lease was lost and that are not to be tried again.
  Status EndLostLeases(std::int64_t now_us) {
    VICTORIOUS_ASSIGN_OR_RETURN(
        Statement end,
        connection_->Prepare("UPDATE jobs SET state = CASE WHEN cancel_asked = 1 THEN 'cancelled' ELSE 'failed' END, "
                             "message = CASE WHEN cancel_asked = 1 THEN message ELSE ? END, ended_utc_us = ?, "
                             "owner = NULL, lease_utc_us = NULL "
                             "WHERE state = 'running' AND lease_utc_us < ? AND (cancel_asked = 1 OR attempts >= ?)"));
    end.Bind(fmt::format("its process was killed {} times: see the log of the server, then start the job again",
                         kMaxAttempts),
             now_us, now_us, kMaxAttempts);
    return end.Run();
  }

  std::unique_ptr<Connection> connection_;
};

}  // namespace
}  // namespace victorious::sqlite

namespace victorious {

Expected<std::unique_ptr<JobQueue>> OpenSqliteJobQueue(const std::filesystem::path& path) {
  VICTORIOUS_ASSIGN_OR_RETURN(auto connection, sqlite::OpenDatabase(path, StoreMode::kCreate));
  return std::make_unique<sqlite::SqliteJobQueue>(std::move(connection));
}

}  // namespace victorious

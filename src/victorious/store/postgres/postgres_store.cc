#include "victorious/store/postgres/postgres_store.h"

#include <chrono>
#include <thread>

#include <fmt/format.h>

#include "victorious/store/postgres/migrations.h"

namespace victorious::postgres {

Status PostgresStore::ReserveTrackletIds(std::map<std::int64_t, std::int64_t>& by_video) {
  constexpr std::int64_t kIdsPerVideo = 1'000'000'000;
  for (auto& [video, number] : by_video) {
    VICTORIOUS_ASSIGN_OR_RETURN(Result made,
                                connection_->Query("UPDATE videos SET tracklets_made = tracklets_made + ? WHERE id = ? "
                                                   "RETURNING (id - 1) * ? + tracklets_made - ? + 1",
                                                   number, video, kIdsPerVideo, number));
    if (!made.Next()) return std::unexpected(sql::MissingRow(connection_->name(), "video", video));
    number = made.Integer(0);
  }
  return {};
}

Status PostgresStore::AssignAllReviews() { return connection_->Execute("SELECT victorious.assign_all_reviews()"); }

Status PostgresStore::AssignReviewsOf(std::span<const std::int64_t> tracklets) {
  return connection_->Execute(
      fmt::format("SELECT victorious.assign_reviews_of('{}')", sql::ListText(sql::Dialect::kPostgres, tracklets)));
}

Status PostgresStore::SummariseDecisions(std::int64_t object) {
  return connection_->Execute(fmt::format("SELECT victorious.summarise_decisions('{{{}}}')", object));
}

Status PostgresStore::UpdateObjects(const std::function<Expected<ObjectUpdate>()>& make, const CancelToken& cancel) {
  // A connection that was lost and opened again has lost the lock.
  constexpr int kMaxTries = 3;
  for (int tries = 1;; ++tries) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t session, LockObjects(cancel));
    const Expected<ObjectUpdate> update = make();
    VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t session_now, Session());
    const bool is_locked = session_now == session;
    if (update && !is_locked && tries < kMaxTries) continue;
    Status status;
    if (!update) {
      status = std::unexpected(update.error());
    } else if (!is_locked) {
      status = Fail(ErrorCode::kInternal,
                    fmt::format("{}: the connection was lost again and again: run this again", connection_->name()));
    } else {
      status = WriteUpdate(*update);
    }
    if (is_locked) VICTORIOUS_RETURN_IF_ERROR(UnlockObjects());
    return status;
  }
}

Expected<std::int64_t> PostgresStore::Session() {
  VICTORIOUS_ASSIGN_OR_RETURN(Result row, connection_->Query("SELECT pg_backend_pid()::bigint"));
  return row.Next() ? row.Integer(0) : 0;
}

// Held over several transactions: by the session, not by one of them.
Expected<std::int64_t> PostgresStore::LockObjects(const CancelToken& cancel) {
  constexpr std::chrono::milliseconds kPoll{100};
  const auto begun = std::chrono::steady_clock::now();
  while (true) {
    VICTORIOUS_ASSIGN_OR_RETURN(
        Result row, connection_->Query("SELECT pg_try_advisory_lock(?), pg_backend_pid()::bigint", kObjectsLockKey));
    if (row.Next() && row.Integer(0) != 0) {
      // A process that stands still for long must not hold up all others.
      VICTORIOUS_RETURN_IF_ERROR(
          connection_->Execute(fmt::format("SET idle_session_timeout = {}", ObjectsPatience{}.others.count())));
      return row.Integer(1);
    }
    const bool is_cancelled = cancel.IsCancelled();
    const auto waited = std::chrono::steady_clock::now() - begun;
    if (waited >= (is_cancelled ? patience_.cancelled : patience_.others)) {
      VICTORIOUS_ASSIGN_OR_RETURN(const std::string holder, DescribeHolder());
      return Fail(
          is_cancelled ? ErrorCode::kCancelled : ErrorCode::kUnavailable,
          fmt::format("{}: the sightings are stored, the objects not updated: another process updates them ({}); "
                      "run this again",
                      connection_->name(), holder));
    }
    std::this_thread::sleep_for(kPoll);
  }
}

Expected<std::string> PostgresStore::DescribeHolder() {
  VICTORIOUS_ASSIGN_OR_RETURN(
      Result row, connection_->Query(
                      "SELECT a.pid::bigint, a.usename::text, host(a.client_addr) FROM pg_locks l JOIN "
                      "pg_stat_activity a USING (pid) WHERE l.locktype = 'advisory' AND l.granted AND l.objsubid = 1 "
                      "AND l.classid::bigint = 0 AND l.objid::bigint = ? AND a.datname = current_database()",
                      kObjectsLockKey));
  if (!row.Next()) return "which ended just now";
  const std::string address = row.Text(2);
  return fmt::format("server process {} of the role {}{}", row.Integer(0), row.Text(1),
                     address.empty() ? "" : " from " + address);
}

Status PostgresStore::UnlockObjects() {
  VICTORIOUS_RETURN_IF_ERROR(connection_->Execute("SET idle_session_timeout = 0"));
  VICTORIOUS_RETURN_IF_ERROR(connection_->Query("SELECT pg_advisory_unlock(?)", kObjectsLockKey));
  return {};
}

Expected<std::vector<std::string>> PostgresStore::FindFaults() {
  std::vector<std::string> faults;
  const auto add = [&](const Status& status) -> Status {
    if (!status && status.error().code != ErrorCode::kDataLoss) return status;
    if (!status) faults.push_back(status.error().message);
    return {};
  };
  // The server keeps these rules, unless its files are damaged or an administrator turned its triggers off.
  struct Reference {
    std::string_view table, column, parent;
  };
  for (const auto& [table, column, parent] :
       {Reference{"videos", "features_options_id", "options"}, Reference{"searches", "video_id", "videos"},
        Reference{"searches", "model_id", "models"}, Reference{"searches", "options_id", "options"},
        Reference{"objects", "model_id", "models"}, Reference{"tracklets", "object_id", "objects"},
        Reference{"tracklets", "video_id", "videos"}, Reference{"tracklets", "model_id", "models"},
        Reference{"sightings", "tracklet_id", "tracklets"}, Reference{"kept_fits", "tracklet_id", "tracklets"},
        Reference{"kept_frames", "video_id", "videos"}}) {
    const auto count = [&]() -> Status {
      VICTORIOUS_ASSIGN_OR_RETURN(Result rows, connection_->Query(fmt::format(
                                                   "SELECT count(*) FROM {0} c WHERE c.{1} IS NOT NULL AND NOT EXISTS "
                                                   "(SELECT 1 FROM {2} p WHERE p.id = c.{1})",
                                                   table, column, parent)));
      const std::int64_t missing = rows.Next() ? rows.Integer(0) : 0;
      if (missing > 0) faults.push_back(fmt::format("rows of {} without their row of {}: {}", table, parent, missing));
      return {};
    };
    VICTORIOUS_RETURN_IF_ERROR(add(count()));
  }
  // What cannot be read is named by the error.
  VICTORIOUS_RETURN_IF_ERROR(ReadEverything(add));
  return faults;
}

}  // namespace victorious::postgres

namespace victorious {

Expected<std::unique_ptr<IndexStore>> OpenPostgresStore(const std::string& url, StoreMode mode,
                                                        std::optional<TaskAttempt> task) {
  VICTORIOUS_ASSIGN_OR_RETURN(auto connection, postgres::OpenIndex(url, mode, task));
  return std::make_unique<postgres::PostgresStore>(std::move(connection));
}

}  // namespace victorious

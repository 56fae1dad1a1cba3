#include "victorious/store/sqlite/sqlite_store.h"

#include <utility>

#include <fmt/format.h>

#include "victorious/store/sqlite/open_database.h"
#include "victorious/store/sqlite/page_checksums.h"

namespace victorious::sqlite {
namespace {

using sql::Dialect;
using sql::ValueList;

// Follows the decisions about some objects: the latest with a verdict, else the latest of all; NULL without any.
// @param where  selects from objects
std::string AssignTeamReview(std::string_view where) {
  return fmt::format(
      "UPDATE objects SET (verdict, note, reviewer, reviewed_utc_us) = "
      "(SELECT d.verdict, d.note, d.reviewer, d.decided_utc_us FROM decisions d WHERE d.object_id = objects.id "
      "ORDER BY d.verdict IS NULL, d.decided_utc_us DESC, d.reviewer LIMIT 1), "
      "is_contested = (SELECT count(DISTINCT d.verdict) > 1 FROM decisions d WHERE d.object_id = objects.id) "
      "WHERE {}",
      where);
}

// Makes decisions of each person's latest reviews that belong to an object's sightings; an older one changes nothing.
// @param from, where  joins r (reviews), s (sightings) and t (tracklets)
std::string AddDecisions(std::string_view from, std::string_view where) {
  // The columns that stand beside max() are those of its row.
  return fmt::format(
      "INSERT INTO decisions (object_id, reviewer, verdict, note, decided_utc_us) "
      "SELECT t.object_id, r.reviewer, r.verdict, r.note, max(r.updated_utc_us) FROM {} WHERE {} AND {} "
      "GROUP BY t.object_id, r.reviewer "
      "ON CONFLICT DO UPDATE SET verdict = excluded.verdict, note = excluded.note, "
      "decided_utc_us = excluded.decided_utc_us WHERE excluded.decided_utc_us > decisions.decided_utc_us",
      from, where, sql::IsReviewOfSighting(Dialect::kSqlite));
}

}  // namespace

Status SqliteStore::UpdateObjects(const std::function<Expected<ObjectUpdate>()>& make, const CancelToken& /*cancel*/) {
  // A process that changes the index again and again meanwhile will itself update the objects; one that corrected them
  // may have done so already.
  constexpr int kMaxTries = 3;
  for (int tries = 1;; ++tries) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t before, ChangeNumber());
    VICTORIOUS_ASSIGN_OR_RETURN(const std::string corrections, CorrectionsMark());
    VICTORIOUS_ASSIGN_OR_RETURN(const ObjectUpdate update, make());
    VICTORIOUS_ASSIGN_OR_RETURN(sql::Change change, sql::Change::Begin(database(), sql::Exclusion::kAll));
    VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t now, ChangeNumber());
    if (now != before && tries < kMaxTries) continue;
    VICTORIOUS_ASSIGN_OR_RETURN(const std::string corrections_now, CorrectionsMark());
    if (corrections_now != corrections) continue;
    VICTORIOUS_RETURN_IF_ERROR(WriteUpdate(update));
    return change.Commit();
  }
}

// The ids that AUTOINCREMENT would give.
Status SqliteStore::ReserveTrackletIds(std::map<std::int64_t, std::int64_t>& by_video) {
  VICTORIOUS_ASSIGN_OR_RETURN(
      std::int64_t last,
      database().ReadInteger("SELECT seq FROM sqlite_sequence WHERE name = 'tracklets'", ValueList()));
  for (auto& [video, number] : by_video) last += std::exchange(number, last + 1);
  return {};
}

Status SqliteStore::AssignAllReviews() {
  VICTORIOUS_RETURN_IF_ERROR(
      connection_->Execute("UPDATE objects SET verdict = NULL, note = NULL, reviewer = NULL, reviewed_utc_us = NULL, "
                           "is_contested = 0 WHERE reviewed_utc_us IS NOT NULL; DELETE FROM decisions"));
  // CROSS JOIN: from each review to its frame, in this order.
  VICTORIOUS_RETURN_IF_ERROR(
      database().Write(AddDecisions("reviews r CROSS JOIN videos v ON v.content_id = r.video_content_id "
                                    "CROSS JOIN models m ON m.name = r.model_name "
                                    "CROSS JOIN sightings s ON s.video_id = v.id AND s.frame = r.frame "
                                    "CROSS JOIN tracklets t ON t.id = s.tracklet_id AND t.model_id = m.id",
                                    "t.object_id IS NOT NULL"),
                       ValueList()));
  return connection_->Execute(AssignTeamReview("id IN (SELECT object_id FROM decisions)"));
}

Status SqliteStore::AssignReviewsOf(std::span<const std::int64_t> tracklets) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t any,
                              database().ReadInteger("SELECT EXISTS (SELECT 1 FROM reviews)", ValueList()));
  if (any == 0) return {};
  const ValueList ids(sql::ListText(Dialect::kSqlite, tracklets));
  VICTORIOUS_RETURN_IF_ERROR(
      database().Write(AddDecisions(sql::FromReviewedTracklets(Dialect::kSqlite),
                                    "t.object_id IS NOT NULL AND " + sql::IsOneOf(Dialect::kSqlite, "t.id")),
                       ids));
  VICTORIOUS_RETURN_IF_ERROR(
      database().Write(AssignTeamReview(fmt::format("id IN (SELECT t.object_id FROM tracklets t JOIN decisions d ON "
                                                    "d.object_id = t.object_id WHERE {})",
                                                    sql::IsOneOf(Dialect::kSqlite, "t.id"))),
                       ids));
  return {};
}

Status SqliteStore::SummariseDecisions(std::int64_t object) {
  VICTORIOUS_RETURN_IF_ERROR(database().Write(AssignTeamReview("id = ?"), ValueList(object)));
  return {};
}

Expected<std::vector<std::string>> SqliteStore::FindFaults() {
  std::vector<std::string> faults;
  constexpr std::size_t kMaxFaults = 100;  // the default number of messages of SQLite's own check
  VICTORIOUS_RETURN_IF_ERROR(database().Visit("PRAGMA integrity_check", ValueList(), sql::RowCount::kFew,
                                              [&](const sql::Row& row) -> Expected<bool> {
                                                if (row.Text(0) != "ok") faults.push_back(row.Text(0));
                                                return true;
                                              }));
  VICTORIOUS_RETURN_IF_ERROR(
      database().Visit("SELECT \"table\", count(*), parent FROM pragma_foreign_key_check GROUP BY \"table\", parent",
                       ValueList(), sql::RowCount::kFew, [&](const sql::Row& row) -> Expected<bool> {
                         if (faults.size() >= kMaxFaults) return false;
                         faults.push_back(fmt::format("rows of {} without their row of {}: {}", row.Text(0),
                                                      row.Text(2), row.Integer(1)));
                         return true;
                       }));
  // What cannot be read is named by the error.
  VICTORIOUS_RETURN_IF_ERROR(ReadEverything([&](const Status& read) -> Status {
    if (!read) faults.push_back(read.error().message);
    return {};
  }));
  // Last: what was found above says more.
  PageCheck sums;
  if (!CheckPages(connection_->handle(), sums)) faults.push_back(connection_->name() + ": its pages cannot be read");
  for (const std::int64_t page : sums.damaged) {
    if (faults.size() >= kMaxFaults) break;
    faults.push_back(fmt::format("page {} does not match its checksum: damaged, or changed by another program", page));
  }
  return faults;
}

}  // namespace victorious::sqlite

namespace victorious {

Expected<std::unique_ptr<IndexStore>> OpenSqliteStore(const std::filesystem::path& path, StoreMode mode) {
  VICTORIOUS_ASSIGN_OR_RETURN(std::shared_ptr<sqlite::Connection> connection, sqlite::OpenDatabase(path, mode));
  return std::make_unique<sqlite::SqliteStore>(connection);
}

}  // namespace victorious

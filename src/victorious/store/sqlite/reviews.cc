// The reviews of an index: bound to a sighting's place in a video, resolved to the object that is there at present.
#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "victorious/base/enum_text.h"
#include "victorious/store/sql/audit.h"
#include "victorious/store/sql/records.h"
#include "victorious/store/sqlite/sqlite_store.h"

namespace victorious::sqlite {
namespace {

// Two boxes in one frame that overlap at least this much show the same object: another search of the same video moves
// an outline by some pixels.
constexpr double kMinOverlap = 0.5;

// The columns of the key of reviews but the reviewer.
constexpr std::string_view kKey =
    "video_content_id, model_name, frame, box_x_px, box_y_px, box_width_px, box_height_px";

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

Box ReadBox(const Statement& row, int first_column) {
  return {row.Real(first_column), row.Real(first_column + 1), row.Real(first_column + 2), row.Real(first_column + 3)};
}

// What a review is bound to.
struct Anchor {
  std::string video_content_id;
  std::string model_name;
  std::int64_t frame = 0;
  Box box;

  // Bound parameters in the order of kKey, followed by `values`.
  template <typename... Values>
  void Bind(Statement& statement, const Values&... values) const {
    statement.Bind(video_content_id, model_name, frame, box.x, box.y, box.width, box.height, values...);
  }
};

Anchor ReadAnchor(const Statement& row) { return {row.Text(0), row.Text(1), row.Integer(2), ReadBox(row, 3)}; }

// The anchors of new reviews of an object: the first sighting of each of its tracklets.
Expected<std::vector<Anchor>> FirstSightings(Connection& connection, std::int64_t object) {
  VICTORIOUS_ASSIGN_OR_RETURN(
      Statement select,
      connection.Prepare("SELECT v.content_id, m.name, s.frame, s.box_x_px, s.box_y_px, s.box_width_px, "
                         "s.box_height_px FROM tracklets t JOIN videos v ON v.id = t.video_id "
                         "JOIN models m ON m.id = t.model_id JOIN sightings s ON s.video_id = t.video_id AND "
                         "s.tracklet_id = t.id AND s.frame = (SELECT min(frame) FROM sightings "
                         "WHERE tracklet_id = t.id) WHERE t.object_id = ? ORDER BY t.id"));
  select.Bind(object);
  std::vector<Anchor> anchors;
  while (true) {
    VICTORIOUS_ASSIGN_OR_RETURN(const bool has_row, select.Step());
    if (!has_row) return anchors;
    anchors.push_back(ReadAnchor(select));
  }
}

// The anchors of the stored reviews of a person that belong to an object.
Expected<std::vector<Anchor>> StoredAnchors(Connection& connection, std::int64_t object, const std::string& reviewer) {
  VICTORIOUS_ASSIGN_OR_RETURN(
      Statement select,
      connection.Prepare(
          "SELECT r.video_content_id, r.model_name, r.frame, r.box_x_px, r.box_y_px, r.box_width_px, r.box_height_px, "
          "s.box_x_px, s.box_y_px, s.box_width_px, s.box_height_px "
          "FROM tracklets t CROSS JOIN videos v ON v.id = t.video_id CROSS JOIN models m ON m.id = t.model_id "
          "CROSS JOIN reviews r ON r.video_content_id = v.content_id AND r.model_name = m.name "
          "CROSS JOIN sightings s ON s.video_id = t.video_id AND s.frame = r.frame AND s.tracklet_id = t.id "
          "WHERE t.object_id = ? AND r.reviewer = ?"));
  select.Bind(object, reviewer);
  std::vector<Anchor> anchors;
  while (true) {
    VICTORIOUS_ASSIGN_OR_RETURN(const bool has_row, select.Step());
    if (!has_row) return anchors;
    Anchor anchor = ReadAnchor(select);
    if (IntersectionOverUnion(anchor.box, ReadBox(select, 7)) >= kMinOverlap) anchors.push_back(std::move(anchor));
  }
}

// Makes decisions of each person's latest reviews that overlap an object's sightings; an older one changes nothing.
// Parameter 1: the overlap that is needed.
// @param from, where  joins r (reviews), s (sightings) and t (tracklets)
std::string AddDecisions(std::string_view from, std::string_view where) {
  // The columns that stand beside max() are those of its row.
  return fmt::format(
      "INSERT INTO decisions (object_id, reviewer, verdict, note, decided_utc_us) "
      "SELECT object_id, reviewer, verdict, note, max(updated_utc_us) FROM "
      "(SELECT t.object_id, r.*, r.box_width_px * r.box_height_px + s.box_width_px * s.box_height_px AS areas, "
      "max(0, min(r.box_x_px + r.box_width_px, s.box_x_px + s.box_width_px) - max(r.box_x_px, s.box_x_px)) * "
      "max(0, min(r.box_y_px + r.box_height_px, s.box_y_px + s.box_height_px) - max(r.box_y_px, s.box_y_px)) "
      "AS common FROM {} WHERE {}) WHERE common >= ?1 * (areas - common) GROUP BY object_id, reviewer "
      "ON CONFLICT DO UPDATE SET verdict = excluded.verdict, note = excluded.note, "
      "decided_utc_us = excluded.decided_utc_us WHERE excluded.decided_utc_us > decisions.decided_utc_us",
      from, where);
}

// The same review, decided after all others of the object: a clock that was set back makes no newer one the older.
Expected<Review> AfterOthers(Connection& connection, std::int64_t object, Review review) {
  VICTORIOUS_ASSIGN_OR_RETURN(
      Statement latest,
      connection.Prepare("SELECT coalesce(max(decided_utc_us) + 1, 0) FROM decisions WHERE object_id = ?"));
  latest.Bind(object);
  VICTORIOUS_ASSIGN_OR_RETURN([[maybe_unused]] const bool has_row, latest.Step());
  review.updated_utc_us = std::max(review.updated_utc_us, latest.Integer(0));
  return review;
}

Status LogReview(Connection& connection, std::int64_t object, const Review& review, const Anchor& place) {
  const AuditRecord record = sql::AuditOfReview(object, review, place.model_name, place.video_content_id, place.frame);
  VICTORIOUS_ASSIGN_OR_RETURN(Statement insert, connection.Prepare(sql::kInsertAudit));
  return insert.Bind(record.time_utc_us, record.actor, record.action, record.subject, record.detail).Run();
}

}  // namespace

Status SqliteStore::PutReview(std::int64_t object, const Review& given) {
  VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<Anchor> places, FirstSightings(*connection_, object));
  if (places.empty()) {
    return Fail(ErrorCode::kNotFound,
                fmt::format("{}: object {} does not exist (another process may have deleted or joined it)",
                            connection_->name(), object));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const Review review, AfterOthers(*connection_, object, given));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<Anchor> replaced, StoredAnchors(*connection_, object, review.reviewer));
  const auto verdict = review.verdict ? std::optional(std::string(ToText(*review.verdict))) : std::nullopt;
  {
    VICTORIOUS_ASSIGN_OR_RETURN(
        Statement remove, connection_->Prepare(fmt::format(
                              "DELETE FROM reviews WHERE ({}, reviewer) = (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8)", kKey)));
    for (const Anchor& anchor : replaced) {
      anchor.Bind(remove, review.reviewer);
      VICTORIOUS_RETURN_IF_ERROR(remove.Run());
    }
    VICTORIOUS_ASSIGN_OR_RETURN(
        Statement insert,
        connection_->Prepare(fmt::format("INSERT OR REPLACE INTO reviews ({}, verdict, note, updated_utc_us, reviewer) "
                                         "VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
                                         kKey)));
    for (const Anchor& anchor : places) {
      if (review.IsEmpty()) break;
      anchor.Bind(insert, verdict, review.note, review.updated_utc_us, review.reviewer);
      VICTORIOUS_RETURN_IF_ERROR(insert.Run());
    }
    VICTORIOUS_RETURN_IF_ERROR(PutDecision(object, review));
    VICTORIOUS_RETURN_IF_ERROR(LogReview(*connection_, object, review, places.front()));
  }
  return transaction.Commit();
}

Status SqliteStore::PutDecision(std::int64_t object, const Review& review) {
  const auto verdict = review.verdict ? std::optional(std::string(ToText(*review.verdict))) : std::nullopt;
  if (review.IsEmpty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(Statement remove,
                                connection_->Prepare("DELETE FROM decisions WHERE object_id = ? AND reviewer = ?"));
    remove.Bind(object, review.reviewer);
    VICTORIOUS_RETURN_IF_ERROR(remove.Run());
  } else {
    VICTORIOUS_ASSIGN_OR_RETURN(Statement insert,
                                connection_->Prepare("INSERT OR REPLACE INTO decisions (object_id, reviewer, verdict, "
                                                     "note, decided_utc_us) VALUES (?, ?, ?, ?, ?)"));
    insert.Bind(object, review.reviewer, verdict, review.note, review.updated_utc_us);
    VICTORIOUS_RETURN_IF_ERROR(insert.Run());
  }
  VICTORIOUS_ASSIGN_OR_RETURN(Statement assign, connection_->Prepare(AssignTeamReview("id = ?")));
  return assign.Bind(object).Run();
}

Status SqliteStore::AssignAllReviews() {
  VICTORIOUS_RETURN_IF_ERROR(
      connection_->Execute("UPDATE objects SET verdict = NULL, note = NULL, reviewer = NULL, reviewed_utc_us = NULL, "
                           "is_contested = 0 WHERE reviewed_utc_us IS NOT NULL; DELETE FROM decisions"));
  // CROSS JOIN: from each review to its frame, in this order.
  VICTORIOUS_ASSIGN_OR_RETURN(Statement add, connection_->Prepare(AddDecisions(
                                                 "reviews r CROSS JOIN videos v ON v.content_id = r.video_content_id "
                                                 "CROSS JOIN models m ON m.name = r.model_name "
                                                 "CROSS JOIN sightings s ON s.video_id = v.id AND s.frame = r.frame "
                                                 "CROSS JOIN tracklets t ON t.id = s.tracklet_id AND t.model_id = m.id",
                                                 "t.object_id IS NOT NULL")));
  VICTORIOUS_RETURN_IF_ERROR(add.Bind(kMinOverlap).Run());
  return connection_->Execute(AssignTeamReview("id IN (SELECT object_id FROM decisions)"));
}

Status SqliteStore::AssignReviewsOf(std::span<const std::int64_t> tracklets) {
  {
    VICTORIOUS_ASSIGN_OR_RETURN(Statement any, connection_->Prepare("SELECT EXISTS (SELECT 1 FROM reviews)"));
    VICTORIOUS_RETURN_IF_ERROR(any.Step());
    if (any.Integer(0) == 0) return {};
  }
  const std::string ids = fmt::format("[{}]", fmt::join(tracklets, ","));
  // CROSS JOIN: from each tracklet to the reviews of its model in its video, in this order.
  VICTORIOUS_ASSIGN_OR_RETURN(
      Statement add,
      connection_->Prepare(AddDecisions(
          "tracklets t CROSS JOIN videos v ON v.id = t.video_id CROSS JOIN models m ON m.id = t.model_id "
          "CROSS JOIN reviews r ON r.video_content_id = v.content_id AND r.model_name = m.name "
          "CROSS JOIN sightings s ON s.video_id = t.video_id AND s.frame = r.frame AND s.tracklet_id = t.id",
          "t.object_id IS NOT NULL AND t.id IN (SELECT value FROM json_each(?2))")));
  VICTORIOUS_RETURN_IF_ERROR(add.Bind(kMinOverlap, ids).Run());
  VICTORIOUS_ASSIGN_OR_RETURN(Statement assign, connection_->Prepare(AssignTeamReview(
                                                    "id IN (SELECT t.object_id FROM tracklets t JOIN decisions d ON "
                                                    "d.object_id = t.object_id WHERE t.id IN (SELECT value FROM "
                                                    "json_each(?)))")));
  return assign.Bind(ids).Run();
}

Expected<std::vector<Review>> SqliteStore::Decisions(std::int64_t object) {
  VICTORIOUS_ASSIGN_OR_RETURN(Statement select,
                              connection_->Prepare("SELECT d.verdict, d.note, d.reviewer, d.decided_utc_us "
                                                   "FROM decisions d JOIN objects o ON o.id = d.object_id "
                                                   "WHERE d.object_id = ? AND coalesce(o.frames, 0) > 0 "
                                                   "ORDER BY d.decided_utc_us DESC, d.reviewer"));
  select.Bind(object);
  std::vector<Review> decisions;
  while (true) {
    VICTORIOUS_ASSIGN_OR_RETURN(const bool has_row, select.Step());
    if (!has_row) return decisions;
    VICTORIOUS_ASSIGN_OR_RETURN(Review decision, sql::ReadReview(select, 0, connection_->name()));
    decisions.push_back(std::move(decision));
  }
}

Expected<std::vector<ReviewedObject>> SqliteStore::Reviews() {
  VICTORIOUS_ASSIGN_OR_RETURN(
      Statement select,
      connection_->Prepare("SELECT verdict, note, reviewer, reviewed_utc_us, id FROM objects "
                           "WHERE reviewed_utc_us IS NOT NULL AND coalesce(frames, 0) > 0 ORDER BY id"));
  std::vector<ReviewedObject> reviews;
  while (true) {
    VICTORIOUS_ASSIGN_OR_RETURN(const bool has_row, select.Step());
    if (!has_row) return reviews;
    VICTORIOUS_ASSIGN_OR_RETURN(Review review, sql::ReadReview(select, 0, connection_->name()));
    reviews.push_back({select.Integer(4), std::move(review)});
  }
}

Expected<std::int64_t> SqliteStore::ChangeNumber() {
  VICTORIOUS_ASSIGN_OR_RETURN(Statement select, connection_->Prepare("PRAGMA data_version"));
  VICTORIOUS_ASSIGN_OR_RETURN([[maybe_unused]] const bool has_row, select.Step());
  return select.Integer(0);
}

}  // namespace victorious::sqlite

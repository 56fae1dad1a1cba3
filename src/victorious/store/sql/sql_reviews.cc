// The part of SqlIndexStore that keeps the reviews: bound to a sighting's place in a video, resolved to the object that
// is there at present.
#include <algorithm>

#include <fmt/format.h>

#include "victorious/base/enum_text.h"
#include "victorious/store/sql/audit.h"
#include "victorious/store/sql/records.h"
#include "victorious/store/sql/sql_index_store.h"

namespace victorious::sql {
namespace {

// The columns of the key of reviews but the reviewer.
constexpr std::string_view kKey =
    "video_content_id, model_name, frame, box_x_px, box_y_px, box_width_px, box_height_px";

// The length of what two boxes share along an axis.
std::string SharedLength(Dialect dialect, std::string_view from, std::string_view length) {
  return Greater(dialect, "0",
                 fmt::format("{} - {}",
                             Lesser(dialect, fmt::format("r.{0} + r.{1}", from, length),
                                    fmt::format("s.{0} + s.{1}", from, length)),
                             Greater(dialect, fmt::format("r.{}", from), fmt::format("s.{}", from))));
}

// The place that the log names an object by.
struct FirstPlace {
  std::string model_name;
  std::string video_content_id;
  std::int64_t frame = 0;
};

Expected<std::optional<FirstPlace>> FindFirstPlace(Database& database, std::int64_t object) {
  return database.ReadOne(
      fmt::format("SELECT m.name, v.content_id, s.frame {} WHERE t.object_id = ? ORDER BY t.id LIMIT 1",
                  FromFirstSightings(database.dialect())),
      ValueList(object), [](const Row& row) {
        return FirstPlace{.model_name = row.Text(0), .video_content_id = row.Text(1), .frame = row.Integer(2)};
      });
}

Status AddReview(Database& database, std::int64_t object, const Review& review) {
  const auto verdict = review.verdict ? std::optional(std::string(ToText(*review.verdict))) : std::nullopt;
  VICTORIOUS_RETURN_IF_ERROR(database.Write(
      fmt::format("INSERT INTO reviews ({0}, verdict, note, updated_utc_us, reviewer) SELECT v.content_id, m.name, "
                  "s.frame, s.box_x_px, s.box_y_px, s.box_width_px, s.box_height_px, CAST(? AS text), ?, ?, ? {1} "
                  "WHERE t.object_id = ? "
                  "ON CONFLICT ({0}, reviewer) DO UPDATE SET verdict = excluded.verdict, note = excluded.note, "
                  "updated_utc_us = excluded.updated_utc_us",
                  kKey, FromFirstSightings(database.dialect())),
      ValueList(verdict, review.note, review.updated_utc_us, review.reviewer, object)));
  VICTORIOUS_RETURN_IF_ERROR(database.Write(
      "INSERT INTO decisions (object_id, reviewer, verdict, note, decided_utc_us) VALUES (?, ?, ?, ?, ?) "
      "ON CONFLICT (object_id, reviewer) DO UPDATE SET verdict = excluded.verdict, note = excluded.note, "
      "decided_utc_us = excluded.decided_utc_us",
      ValueList(object, review.reviewer, verdict, review.note, review.updated_utc_us)));
  return {};
}

}  // namespace

std::string FromFirstSightings(Dialect dialect) {
  return fmt::format(
      "FROM tracklets t JOIN videos v ON v.id = t.video_id JOIN models m ON m.id = t.model_id "
      "JOIN sightings s ON s.video_id = t.video_id AND s.tracklet_id = t.id AND s.frame = "
      "(SELECT min(f.frame) FROM sightings f{} WHERE f.video_id = t.video_id AND f.tracklet_id = t.id)",
      IndexedBy(dialect, "sightings_by_tracklet"));
}

std::string FromReviewedTracklets(Dialect dialect) {
  return fmt::format(
      "tracklets t {0} videos v ON v.id = t.video_id {0} models m ON m.id = t.model_id "
      "{0} reviews r ON r.video_content_id = v.content_id AND r.model_name = m.name "
      "{0} sightings s ON s.video_id = t.video_id AND s.frame = r.frame AND s.tracklet_id = t.id",
      JoinInOrder(dialect));
}

// Two boxes in one frame show the same object if their intersection over union is at least a half, which is
// 3 intersections >= the sum of both areas: another search of the same video moves an outline by some pixels.
std::string IsReviewOfSighting(Dialect dialect) {
  return fmt::format("3 * {} * {} >= r.box_width_px * r.box_height_px + s.box_width_px * s.box_height_px",
                     SharedLength(dialect, "box_x_px", "box_width_px"),
                     SharedLength(dialect, "box_y_px", "box_height_px"));
}

Status SqlIndexStore::PutReview(std::int64_t object, const Review& given) {
  VICTORIOUS_ASSIGN_OR_RETURN(Change change, Change::Begin(*database_, Exclusion::kAll));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<FirstPlace> place, FindFirstPlace(*database_, object));
  if (!place) {
    return Fail(ErrorCode::kNotFound,
                fmt::format("{}: object {} does not exist (another process may have deleted or joined it)",
                            database_->name(), object));
  }
  // After all others of the object: a clock that was set back, or another server's, makes no newer one the older.
  VICTORIOUS_ASSIGN_OR_RETURN(
      const std::int64_t after_others,
      database_->ReadInteger("SELECT coalesce(max(decided_utc_us) + 1, 0) FROM decisions WHERE object_id = ?",
                             ValueList(object)));
  Review review = given;
  review.updated_utc_us = std::max(review.updated_utc_us, after_others);
  VICTORIOUS_RETURN_IF_ERROR(database_->Write(
      fmt::format("DELETE FROM reviews WHERE ({0}) IN (SELECT r.video_content_id, r.model_name, r.frame, r.box_x_px, "
                  "r.box_y_px, r.box_width_px, r.box_height_px FROM {1} WHERE t.object_id = ? AND {2}) "
                  "AND reviewer = ?",
                  kKey, FromReviewedTracklets(database_->dialect()), IsReviewOfSighting(database_->dialect())),
      ValueList(object, review.reviewer)));
  if (review.IsEmpty()) {
    VICTORIOUS_RETURN_IF_ERROR(database_->Write("DELETE FROM decisions WHERE object_id = ? AND reviewer = ?",
                                                ValueList(object, review.reviewer)));
  } else {
    VICTORIOUS_RETURN_IF_ERROR(AddReview(*database_, object, review));
  }
  VICTORIOUS_RETURN_IF_ERROR(SummariseDecisions(object));
  VICTORIOUS_RETURN_IF_ERROR(
      AddAudit(*database_, AuditOfReview(object, review, place->model_name, place->video_content_id, place->frame)));
  return change.Commit();
}

Expected<std::vector<ReviewedObject>> SqlIndexStore::Reviews() {
  return database_->ReadAll(
      "SELECT verdict, note, reviewer, reviewed_utc_us, id FROM objects "
      "WHERE reviewed_utc_us IS NOT NULL AND coalesce(frames, 0) > 0 ORDER BY id",
      ValueList(), [&](const Row& row) -> Expected<ReviewedObject> {
        VICTORIOUS_ASSIGN_OR_RETURN(Review review, ReadReview(row, 0, database_->name()));
        return ReviewedObject{row.Integer(4), std::move(review)};
      });
}

Expected<std::vector<Review>> SqlIndexStore::Decisions(std::int64_t object) {
  return database_->ReadAll(
      "SELECT d.verdict, d.note, d.reviewer, d.decided_utc_us FROM decisions d JOIN objects o ON o.id = d.object_id "
      "WHERE d.object_id = ? AND coalesce(o.frames, 0) > 0 ORDER BY d.decided_utc_us DESC, d.reviewer",
      ValueList(object), [&](const Row& row) { return ReadReview(row, 0, database_->name()); });
}

}  // namespace victorious::sql

// The reviews of an index: bound to a sighting's place in a video, resolved to the object that is there at present.
#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "victorious/base/enum_text.h"
#include "victorious/store/postgres/postgres_store.h"
#include "victorious/store/sql/audit.h"
#include "victorious/store/sql/dialect.h"
#include "victorious/store/sql/records.h"

namespace victorious::postgres {
namespace {

// The columns of the key of reviews but the reviewer.
constexpr std::string_view kKey =
    "video_content_id, model_name, frame, box_x_px, box_y_px, box_width_px, box_height_px";

// Each review r with the sighting s, of the tracklet t, that it belongs to. Two boxes in one frame show the same object
// if their intersection over union is at least a half, which is 3 intersections >= the sum of both areas: another
// search of the same video moves an outline by some pixels.
constexpr std::string_view kFromReviews =
    "reviews r JOIN videos v ON v.content_id = r.video_content_id JOIN models m ON m.name = r.model_name "
    "JOIN sightings s ON s.video_id = v.id AND s.frame = r.frame "
    "JOIN tracklets t ON t.id = s.tracklet_id AND t.model_id = m.id AND t.object_id IS NOT NULL AND "
    "3 * greatest(0, least(r.box_x_px + r.box_width_px, s.box_x_px + s.box_width_px) - greatest(r.box_x_px, "
    "s.box_x_px)) * greatest(0, least(r.box_y_px + r.box_height_px, s.box_y_px + s.box_height_px) - "
    "greatest(r.box_y_px, s.box_y_px)) >= r.box_width_px * r.box_height_px + s.box_width_px * s.box_height_px";

// The first sighting of each tracklet of an object, s.
constexpr std::string_view kFirstSightings =
    "FROM tracklets t JOIN videos v ON v.id = t.video_id JOIN models m ON m.id = t.model_id "
    "CROSS JOIN LATERAL (SELECT * FROM sightings f WHERE f.video_id = t.video_id AND f.tracklet_id = t.id "
    "ORDER BY f.frame LIMIT 1) s WHERE t.object_id = ?";

constexpr std::string_view kDecisionColumns = "object_id, reviewer, verdict, note, decided_utc_us";

constexpr std::string_view kReplaceDecision =
    "ON CONFLICT (object_id, reviewer) DO UPDATE SET verdict = excluded.verdict, note = excluded.note, "
    "decided_utc_us = excluded.decided_utc_us";

}  // namespace

Status PostgresStore::PutReview(std::int64_t object, const Review& given) {
  VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_, Exclusion::kAll));
  VICTORIOUS_ASSIGN_OR_RETURN(
      Result place,
      connection_->Query(fmt::format("SELECT m.name, v.content_id, s.frame {} ORDER BY t.id LIMIT 1", kFirstSightings),
                         object));
  if (!place.Next()) {
    return Fail(ErrorCode::kNotFound,
                fmt::format("{}: object {} does not exist (another process may have deleted or joined it)",
                            connection_->name(), object));
  }
  // After all others of the object: a clock that was set back, or another server's, makes no newer one the older.
  VICTORIOUS_ASSIGN_OR_RETURN(
      Result latest,
      connection_->Query("SELECT coalesce(max(decided_utc_us) + 1, 0) FROM decisions WHERE object_id = ?", object));
  Review review = given;
  if (latest.Next()) review.updated_utc_us = std::max(review.updated_utc_us, latest.Integer(0));
  VICTORIOUS_RETURN_IF_ERROR(connection_->Query(
      fmt::format("DELETE FROM reviews WHERE ({0}) IN (SELECT r.video_content_id, r.model_name, r.frame, r.box_x_px, "
                  "r.box_y_px, r.box_width_px, r.box_height_px FROM {1} WHERE t.object_id = ?) AND reviewer = ?",
                  kKey, kFromReviews),
      object, review.reviewer));
  if (review.IsEmpty()) {
    VICTORIOUS_RETURN_IF_ERROR(
        connection_->Query("DELETE FROM decisions WHERE object_id = ? AND reviewer = ?", object, review.reviewer));
  } else {
    const auto verdict = review.verdict ? std::optional(std::string(ToText(*review.verdict))) : std::nullopt;
    VICTORIOUS_RETURN_IF_ERROR(connection_->Query(
        fmt::format(
            "INSERT INTO reviews ({0}, verdict, note, updated_utc_us, reviewer) SELECT v.content_id, m.name, s.frame, "
            "s.box_x_px, s.box_y_px, s.box_width_px, s.box_height_px, ?::text, ?, ?, ? {1} ON CONFLICT ({0}, reviewer) "
            "DO UPDATE SET verdict = excluded.verdict, note = excluded.note, updated_utc_us = excluded.updated_utc_us",
            kKey, kFirstSightings),
        verdict, review.note, review.updated_utc_us, review.reviewer, object));
    VICTORIOUS_RETURN_IF_ERROR(connection_->Query(
        fmt::format("INSERT INTO decisions ({}) VALUES (?, ?, ?, ?, ?) {}", kDecisionColumns, kReplaceDecision), object,
        review.reviewer, verdict, review.note, review.updated_utc_us));
  }
  VICTORIOUS_RETURN_IF_ERROR(
      connection_->Execute(fmt::format("SELECT victorious.summarise_decisions('{{{}}}')", object)));
  const AuditRecord record = sql::AuditOfReview(object, review, place.Text(0), place.Text(1), place.Integer(2));
  VICTORIOUS_RETURN_IF_ERROR(connection_->Query(sql::kInsertAudit, record.time_utc_us, record.actor, record.action,
                                                record.subject, record.detail));
  return transaction.Commit();
}

Status PostgresStore::AssignAllReviews() { return connection_->Execute("SELECT victorious.assign_all_reviews()"); }

Status PostgresStore::AssignReviewsOf(std::span<const std::int64_t> tracklets) {
  if (tracklets.empty()) return {};
  return connection_->Execute(fmt::format("SELECT victorious.assign_reviews_of('{{{}}}')", fmt::join(tracklets, ",")));
}

Expected<std::vector<ReviewedObject>> PostgresStore::Reviews() {
  VICTORIOUS_ASSIGN_OR_RETURN(
      Result rows, connection_->Query("SELECT verdict, note, reviewer, reviewed_utc_us, id FROM objects "
                                      "WHERE reviewed_utc_us IS NOT NULL AND coalesce(frames, 0) > 0 ORDER BY id"));
  std::vector<ReviewedObject> reviews;
  while (rows.Next()) {
    VICTORIOUS_ASSIGN_OR_RETURN(Review review, sql::ReadReview(rows, 0, connection_->name()));
    reviews.push_back({rows.Integer(4), std::move(review)});
  }
  return reviews;
}

Expected<std::vector<Review>> PostgresStore::Decisions(std::int64_t object) {
  VICTORIOUS_ASSIGN_OR_RETURN(
      Result rows, connection_->Query("SELECT d.verdict, d.note, d.reviewer, d.decided_utc_us FROM decisions d "
                                      "JOIN objects o ON o.id = d.object_id WHERE d.object_id = ? AND "
                                      "coalesce(o.frames, 0) > 0 ORDER BY d.decided_utc_us DESC, d.reviewer",
                                      object));
  std::vector<Review> decisions;
  while (rows.Next()) {
    VICTORIOUS_ASSIGN_OR_RETURN(Review decision, sql::ReadReview(rows, 0, connection_->name()));
    decisions.push_back(std::move(decision));
  }
  return decisions;
}

// The snapshot of a statement differs from an earlier one if any transaction of the server that writes began or ended
// between them, also one of another database.
Expected<std::int64_t> PostgresStore::ChangeNumber() {
  VICTORIOUS_ASSIGN_OR_RETURN(Result row,
                              connection_->Query("SELECT hashtextextended(pg_current_snapshot()::text, 0)"));
  return row.Next() ? row.Integer(0) : 0;
}

}  // namespace victorious::postgres

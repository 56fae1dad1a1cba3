// The part of PostgresStore that keeps the videos.
#include <optional>

#include "victorious/base/check.h"
#include "victorious/store/postgres/postgres_store.h"
#include "victorious/store/sql/records.h"

namespace victorious::postgres {

Expected<VideoRecord> PostgresStore::PutVideo(const VideoRecord& video) {
  VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_, Exclusion::kShared));
  std::optional<std::int64_t> features_options;
  if (!video.features_json.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(features_options, PutOptions(video.features_json));
  }
  // Updated first: an INSERT takes an id even if the row exists, and ids follow one another.
  VICTORIOUS_ASSIGN_OR_RETURN(
      const Result updated,
      connection_->Query("UPDATE videos SET name = ?, folder = ?, start_utc_us = CASE WHEN ?::bigint <> 0 THEN NULL "
                         "ELSE coalesce(?, start_utc_us) END, is_of_photos = ?, "
                         "telemetry = coalesce(nullif(?, ''), telemetry) WHERE content_id = ?",
                         video.name, video.folder, video.is_of_photos ? 1 : 0, video.start_utc_us,
                         video.is_of_photos ? 1 : 0, video.telemetry, video.content_id));
  if (updated.Changes() == 0) {
    VICTORIOUS_RETURN_IF_ERROR(connection_->Query(
        "INSERT INTO videos (content_id, name, folder, width_px, height_px, frame_count, duration_s, "
        "features_options_id, start_utc_us, is_of_photos, telemetry) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?) "
        "ON CONFLICT (content_id) DO UPDATE SET "
        "name = excluded.name, folder = excluded.folder, "
        "start_utc_us = coalesce(excluded.start_utc_us, videos.start_utc_us), is_of_photos = excluded.is_of_photos, "
        "telemetry = coalesce(nullif(excluded.telemetry, ''), videos.telemetry)",
        video.content_id, video.name, video.folder, video.width, video.height, video.frame_count, video.duration_s,
        features_options, video.start_utc_us, video.is_of_photos ? 1 : 0, video.telemetry));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(std::optional<VideoRecord> stored, VideoOfContent(video.content_id));
  VICTORIOUS_CHECK(stored.has_value());
  VICTORIOUS_RETURN_IF_ERROR(transaction.Commit());
  return *std::move(stored);
}

Expected<std::optional<VideoRecord>> PostgresStore::VideoOfContent(const std::string& content_id) {
  VICTORIOUS_ASSIGN_OR_RETURN(Result found,
                              connection_->Query(sql::SelectVideos() + "WHERE v.content_id = ?", content_id));
  if (!found.Next()) return std::nullopt;
  return sql::ReadVideo(found);
}

Expected<std::int64_t> PostgresStore::DeleteOtherContent(const std::string& name, const std::string& folder,
                                                         const std::string& content_id) {
  // Deletes the dependent rows as well (ON DELETE CASCADE).
  VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_, Exclusion::kAll));
  VICTORIOUS_ASSIGN_OR_RETURN(
      const Result deleted,
      connection_->Query("DELETE FROM videos WHERE name = ? AND folder IN ('', ?) AND content_id <> ?", name, folder,
                         content_id));
  VICTORIOUS_RETURN_IF_ERROR(transaction.Commit());
  return deleted.Changes();
}

Status PostgresStore::DeleteVideo(std::int64_t video) {
  return DeleteWithObjects("DELETE FROM videos WHERE id = ?", "video", video);
}

Status PostgresStore::DeleteModel(std::int64_t model) {
  return DeleteWithObjects("DELETE FROM models WHERE id = ?", "model", model);
}

// Deletes the dependent rows as well (ON DELETE CASCADE).
Status PostgresStore::DeleteWithObjects(std::string_view statement, const char* what, std::int64_t id) {
  VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_, Exclusion::kAll));
  VICTORIOUS_ASSIGN_OR_RETURN(const Result deleted, connection_->Query(statement, id));
  if (deleted.Changes() != 1) return std::unexpected(Missing(what, id));
  VICTORIOUS_RETURN_IF_ERROR(connection_->Query(sql::kDeleteEmptyObjects));
  return transaction.Commit();
}

Status PostgresStore::SetVideoLength(std::int64_t video, std::int64_t frame_count, double duration_s) {
  VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_, Exclusion::kShared));
  VICTORIOUS_ASSIGN_OR_RETURN(const Result updated,
                              connection_->Query("UPDATE videos SET frame_count = ?, duration_s = ? WHERE id = ?",
                                                 frame_count, duration_s, video));
  if (updated.Changes() != 1) return std::unexpected(Missing("video", video));
  return transaction.Commit();
}

Status PostgresStore::PutShownGround(std::int64_t video, std::span<const GeoBox> boxes) {
  VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_, Exclusion::kShared));
  VICTORIOUS_ASSIGN_OR_RETURN(const Result updated,
                              connection_->Query("UPDATE videos SET has_shown_ground = 1 WHERE id = ?", video));
  if (updated.Changes() != 1) return std::unexpected(Missing("video", video));
  VICTORIOUS_RETURN_IF_ERROR(connection_->Query("DELETE FROM shown_ground WHERE video_id = ?", video));
  for (const GeoBox& box : boxes) {
    VICTORIOUS_RETURN_IF_ERROR(
        connection_->Query("INSERT INTO shown_ground (video_id, south_rad, west_rad, north_rad, east_rad) VALUES "
                           "(?, ?, ?, ?, ?)",
                           video, box.south_rad, box.west_rad, box.north_rad, box.east_rad));
  }
  return transaction.Commit();
}

Status PostgresStore::SetVideoFeatures(std::int64_t video, const std::string& features_json) {
  VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_, Exclusion::kShared));
  std::optional<std::int64_t> options;
  if (!features_json.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(options, PutOptions(features_json));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(
      const Result updated,
      connection_->Query("UPDATE videos SET features_options_id = ? WHERE id = ?", options, video));
  if (updated.Changes() != 1) return std::unexpected(Missing("video", video));
  return transaction.Commit();
}

Expected<std::vector<VideoRecord>> PostgresStore::Videos() {
  VICTORIOUS_ASSIGN_OR_RETURN(Result rows, connection_->Query(sql::SelectVideos() + "ORDER BY v.id"));
  std::vector<VideoRecord> videos;
  while (rows.Next()) videos.push_back(sql::ReadVideo(rows));
  return videos;
}

Expected<std::vector<VideoRecord>> PostgresStore::VideosNamed(const std::string& name) {
  VICTORIOUS_ASSIGN_OR_RETURN(Result rows,
                              connection_->Query(sql::SelectVideos() + "WHERE v.name = ? ORDER BY v.id", name));
  std::vector<VideoRecord> videos;
  while (rows.Next()) videos.push_back(sql::ReadVideo(rows));
  return videos;
}

}  // namespace victorious::postgres

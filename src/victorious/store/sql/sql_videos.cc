// The part of SqlIndexStore that keeps the videos and the models.
#include <optional>

#include "victorious/base/check.h"
#include "victorious/store/sql/records.h"
#include "victorious/store/sql/sql_index_store.h"

namespace victorious::sql {
namespace {

// Deletes the dependent rows as well (ON DELETE CASCADE), and the objects of which nothing is left.
Status DeleteWithObjects(Database& database, const std::string& sql, std::string_view what, std::int64_t id) {
  VICTORIOUS_ASSIGN_OR_RETURN(Change change, Change::Begin(database, Exclusion::kAll));
  VICTORIOUS_RETURN_IF_ERROR(WriteOne(database, sql, ValueList(id), what, id));
  VICTORIOUS_RETURN_IF_ERROR(database.Write(std::string(kDeleteEmptyObjects), ValueList()));
  return change.Commit();
}

// The options that features were kept with; std::nullopt: none were kept. Inside a transaction.
Expected<std::optional<std::int64_t>> PutFeatureOptions(Database& database, const std::string& features_json) {
  if (features_json.empty()) return std::nullopt;
  return PutOptions(database, features_json);
}

}  // namespace

Expected<VideoRecord> SqlIndexStore::PutVideo(const VideoRecord& video) {
  VICTORIOUS_ASSIGN_OR_RETURN(Change change, Change::Begin(*database_, Exclusion::kShared));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<std::int64_t> features_options,
                              PutFeatureOptions(*database_, video.features_json));
  const int is_of_photos = video.is_of_photos ? 1 : 0;
  const auto update = [&] {
    return database_->Write(
        "UPDATE videos SET name = ?, folder = ?, start_utc_us = CASE WHEN CAST(? AS bigint) <> 0 THEN NULL ELSE "
        "coalesce(?, start_utc_us) END, is_of_photos = ?, telemetry = coalesce(nullif(?, ''), telemetry) "
        "WHERE content_id = ?",
        ValueList(video.name, video.folder, is_of_photos, video.start_utc_us, is_of_photos, video.telemetry,
                  video.content_id));
  };
  // Updated first: an INSERT of PostgreSQL takes an id even if the row exists, and ids follow one another.
  VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t updated, update());
  if (updated == 0) {
    VICTORIOUS_ASSIGN_OR_RETURN(
        const std::int64_t added,
        database_->Write(
            "INSERT INTO videos (content_id, name, folder, width_px, height_px, frame_count, duration_s, "
            "features_options_id, start_utc_us, is_of_photos, telemetry) VALUES (?, ?, ?, ?, ?, ?, ?, ?, "
            "?, ?, ?) ON CONFLICT (content_id) DO NOTHING",
            ValueList(video.content_id, video.name, video.folder, video.width, video.height, video.frame_count,
                      video.duration_s, features_options, video.start_utc_us, is_of_photos, video.telemetry)));
    if (added == 0) VICTORIOUS_RETURN_IF_ERROR(update());  // another process has added it meanwhile
  }
  VICTORIOUS_ASSIGN_OR_RETURN(std::optional<VideoRecord> stored, VideoOfContent(video.content_id));
  VICTORIOUS_CHECK(stored.has_value());
  VICTORIOUS_RETURN_IF_ERROR(change.Commit());
  return *std::move(stored);
}

Expected<std::optional<VideoRecord>> SqlIndexStore::VideoOfContent(const std::string& content_id) {
  return database_->ReadOne(SelectVideos() + "WHERE v.content_id = ?", ValueList(content_id), ReadVideo);
}

Expected<std::int64_t> SqlIndexStore::DeleteOtherContent(const std::string& name, const std::string& folder,
                                                         const std::string& content_id) {
  VICTORIOUS_ASSIGN_OR_RETURN(Change change, Change::Begin(*database_, Exclusion::kAll));
  // Deletes the dependent rows as well (ON DELETE CASCADE).
  VICTORIOUS_ASSIGN_OR_RETURN(
      const std::int64_t deleted,
      database_->Write("DELETE FROM videos WHERE name = ? AND folder IN ('', ?) AND content_id <> ?",
                       ValueList(name, folder, content_id)));
  VICTORIOUS_RETURN_IF_ERROR(change.Commit());
  return deleted;
}

Status SqlIndexStore::DeleteVideo(std::int64_t video) {
  return DeleteWithObjects(*database_, "DELETE FROM videos WHERE id = ?", "video", video);
}

Status SqlIndexStore::DeleteModel(std::int64_t model) {
  return DeleteWithObjects(*database_, "DELETE FROM models WHERE id = ?", "model", model);
}

Status SqlIndexStore::SetVideoLength(std::int64_t video, std::int64_t frame_count, double duration_s) {
  VICTORIOUS_ASSIGN_OR_RETURN(Change change, Change::Begin(*database_, Exclusion::kShared));
  VICTORIOUS_RETURN_IF_ERROR(WriteOne(*database_, "UPDATE videos SET frame_count = ?, duration_s = ? WHERE id = ?",
                                      ValueList(frame_count, duration_s, video), "video", video));
  return change.Commit();
}

Status SqlIndexStore::PutShownGround(std::int64_t video, std::span<const GeoBox> boxes) {
  VICTORIOUS_ASSIGN_OR_RETURN(Change change, Change::Begin(*database_, Exclusion::kShared));
  VICTORIOUS_RETURN_IF_ERROR(
      WriteOne(*database_, "UPDATE videos SET has_shown_ground = 1 WHERE id = ?", ValueList(video), "video", video));
  VICTORIOUS_RETURN_IF_ERROR(database_->Write("DELETE FROM shown_ground WHERE video_id = ?", ValueList(video)));
  VICTORIOUS_RETURN_IF_ERROR(
      database_->InsertRows("shown_ground", "video_id, south_rad, west_rad, north_rad, east_rad",
                            {.count = boxes.size(), .bind = [&](std::size_t row, Parameters& values) {
                               const GeoBox& box = boxes[row];
                               values.BindAll(video, box.south_rad, box.west_rad, box.north_rad, box.east_rad);
                             }}));
  return change.Commit();
}

Status SqlIndexStore::SetVideoFeatures(std::int64_t video, const std::string& features_json) {
  VICTORIOUS_ASSIGN_OR_RETURN(Change change, Change::Begin(*database_, Exclusion::kShared));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<std::int64_t> options, PutFeatureOptions(*database_, features_json));
  VICTORIOUS_RETURN_IF_ERROR(WriteOne(*database_, "UPDATE videos SET features_options_id = ? WHERE id = ?",
                                      ValueList(options, video), "video", video));
  return change.Commit();
}

Expected<std::vector<VideoRecord>> SqlIndexStore::Videos() {
  return database_->ReadAll(SelectVideos() + "ORDER BY v.id", ValueList(), ReadVideo);
}

Expected<std::vector<VideoRecord>> SqlIndexStore::VideosNamed(const std::string& name) {
  return database_->ReadAll(SelectVideos() + "WHERE v.name = ? ORDER BY v.id", ValueList(name), ReadVideo);
}

Expected<ModelRecord> SqlIndexStore::PutModel(const ModelRecord& model) {
  const auto find = [&] {
    return database_->ReadOne(SelectModels() + "WHERE name = ?", ValueList(model.name),
                              [&](const Row& row) { return ReadModel(row, database_->name()); });
  };
  VICTORIOUS_ASSIGN_OR_RETURN(Change change, Change::Begin(*database_, Exclusion::kAll));
  // Deletes other content of this name with its dependent rows (ON DELETE CASCADE).
  VICTORIOUS_RETURN_IF_ERROR(database_->Write("DELETE FROM models WHERE name = ? AND content_id <> ?",
                                              ValueList(model.name, model.content_id)));
  VICTORIOUS_ASSIGN_OR_RETURN(std::optional<ModelRecord> stored, find());
  if (!stored) {
    VICTORIOUS_RETURN_IF_ERROR(database_->Write("INSERT INTO models (name, content_id, kind) VALUES (?, ?, ?)",
                                                ValueList(model.name, model.content_id, ToText(model.kind))));
    VICTORIOUS_ASSIGN_OR_RETURN(stored, find());
    VICTORIOUS_CHECK(stored.has_value());
  }
  VICTORIOUS_RETURN_IF_ERROR(change.Commit());
  return *std::move(stored);
}

Expected<std::vector<ModelRecord>> SqlIndexStore::Models() {
  return database_->ReadAll(SelectModels() + "ORDER BY id", ValueList(),
                            [&](const Row& row) { return ReadModel(row, database_->name()); });
}

}  // namespace victorious::sql

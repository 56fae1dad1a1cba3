#include "victorious/store/sqlite/sqlite_store.h"

#include <fmt/format.h>

#include "victorious/base/check.h"
#include "victorious/store/sqlite/conditions.h"
#include "victorious/store/sqlite/open_database.h"
#include "victorious/store/sqlite/records.h"

namespace victorious::sqlite {
namespace {

// All rows of a query, each read by `read`.
template <typename Record>
Expected<std::vector<Record>> ReadAll(Statement& statement, Record (*read)(const Statement&)) {
  std::vector<Record> records;
  while (true) {
    VICTORIOUS_ASSIGN_OR_RETURN(const bool has_row, statement.Step());
    if (!has_row) return records;
    records.push_back(read(statement));
  }
}

// The rows of a query one after the other, until there are no more or `visit` has had enough.
template <typename Record>
Status VisitAll(Statement& statement, std::string_view name,
                Expected<Record> (*read)(const Statement&, std::string_view),
                const std::function<bool(Record&&)>& visit) {
  while (true) {
    VICTORIOUS_ASSIGN_OR_RETURN(const bool has_row, statement.Step());
    if (!has_row) return {};
    VICTORIOUS_ASSIGN_OR_RETURN(Record record, read(statement, name));
    if (!visit(std::move(record))) return {};
  }
}

// The ids of the videos that the filter names. Names are compared here and not in SQL: it knows no path parts.
Status AddVideos(IndexStore& store, const SightingFilter& filter, std::string_view column, Conditions& conditions) {
  if (!filter.video_name) return {};
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<VideoRecord> videos, store.Videos());
  std::vector<std::int64_t> ids;
  for (const VideoRecord& video : VideosNamed(videos, *filter.video_name)) ids.push_back(video.id);
  conditions.AddOneOf(column, ids);
  return {};
}

void AddModel(const SightingFilter& filter, std::string_view column, Conditions& conditions) {
  if (!filter.model_name) return;
  conditions.Add(fmt::format("{} = (SELECT id FROM models WHERE name = ?)", column), *filter.model_name);
}

void AddTimes(const SightingFilter& filter, std::string_view first, std::string_view last, Conditions& conditions) {
  if (filter.from_s) conditions.Add(fmt::format("{} >= ?", last), *filter.from_s);
  if (filter.to_s) conditions.Add(fmt::format("{} <= ?", first), *filter.to_s);
}

}  // namespace

Status SqliteStore::RunOnRow(Statement& statement, std::string_view what, std::int64_t id) {
  VICTORIOUS_RETURN_IF_ERROR(statement.Run());
  if (connection_->Changes() == 1) return {};
  return Fail(ErrorCode::kNotFound, fmt::format("{}: there is no {} {} (another process may have removed it)",
                                                connection_->name(), what, id));
}

Expected<std::int64_t> SqliteStore::PutOptions(const std::string& json) {
  VICTORIOUS_ASSIGN_OR_RETURN(Statement find, connection_->Prepare("SELECT id FROM options WHERE json = ?"));
  VICTORIOUS_ASSIGN_OR_RETURN(const bool found, find.Bind(json).Step());
  if (found) return find.Integer(0);
  VICTORIOUS_ASSIGN_OR_RETURN(Statement insert, connection_->Prepare("INSERT INTO options (json) VALUES (?)"));
  VICTORIOUS_RETURN_IF_ERROR(insert.Bind(json).Run());
  return connection_->LastInsertId();
}

Expected<VideoRecord> SqliteStore::PutVideo(const VideoRecord& video) {
  VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_));
  std::optional<std::int64_t> features_options;
  if (!video.features_json.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(features_options, PutOptions(video.features_json));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(
      Statement put,
      connection_->Prepare("INSERT INTO videos (content_id, name, width_px, height_px, frame_count, duration_s, "
                           "features_options) VALUES (?, ?, ?, ?, ?, ?, ?) "
                           "ON CONFLICT (content_id) DO UPDATE SET name = excluded.name"));
  VICTORIOUS_RETURN_IF_ERROR(put.Bind(video.content_id, video.name, video.width, video.height, video.frame_count,
                                      video.duration_s, features_options)
                                 .Run());
  VICTORIOUS_ASSIGN_OR_RETURN(Statement find,
                              connection_->Prepare(std::string(kSelectVideos) + "WHERE v.content_id = ?"));
  VICTORIOUS_RETURN_IF_ERROR(find.Bind(video.content_id).Step());
  VideoRecord stored = ReadVideo(find);
  VICTORIOUS_RETURN_IF_ERROR(transaction.Commit());
  return stored;
}

Expected<std::int64_t> SqliteStore::ForgetOtherContent(const std::string& name, const std::string& content_id) {
  // What hangs on the old content goes with it (ON DELETE CASCADE).
  VICTORIOUS_ASSIGN_OR_RETURN(Statement forget,
                              connection_->Prepare("DELETE FROM videos WHERE name = ? AND content_id <> ?"));
  VICTORIOUS_RETURN_IF_ERROR(forget.Bind(name, content_id).Run());
  return connection_->Changes();
}

Status SqliteStore::SetVideoLength(std::int64_t video, std::int64_t frame_count, double duration_s) {
  VICTORIOUS_ASSIGN_OR_RETURN(Statement update,
                              connection_->Prepare("UPDATE videos SET frame_count = ?, duration_s = ? WHERE id = ?"));
  update.Bind(frame_count, duration_s, video);
  return RunOnRow(update, "video", video);
}

Status SqliteStore::SetVideoFeatures(std::int64_t video, const std::string& features_json) {
  VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_));
  std::optional<std::int64_t> options;
  if (!features_json.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(options, PutOptions(features_json));
  }
  {
    VICTORIOUS_ASSIGN_OR_RETURN(Statement update,
                                connection_->Prepare("UPDATE videos SET features_options = ? WHERE id = ?"));
    update.Bind(options, video);
    VICTORIOUS_RETURN_IF_ERROR(RunOnRow(update, "video", video));
  }
  return transaction.Commit();
}

Expected<std::vector<VideoRecord>> SqliteStore::Videos() {
  VICTORIOUS_ASSIGN_OR_RETURN(Statement select, connection_->Prepare(std::string(kSelectVideos) + "ORDER BY v.id"));
  return ReadAll(select, &ReadVideo);
}

Expected<ModelRecord> SqliteStore::PutModel(const ModelRecord& model) {
  VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_));
  // What hangs on another content of this name goes with it (ON DELETE CASCADE).
  VICTORIOUS_ASSIGN_OR_RETURN(Statement replace,
                              connection_->Prepare("DELETE FROM models WHERE name = ? AND model_id <> ?"));
  VICTORIOUS_RETURN_IF_ERROR(replace.Bind(model.name, model.model_id).Run());
  VICTORIOUS_ASSIGN_OR_RETURN(Statement put,
                              connection_->Prepare("INSERT INTO models (name, model_id, kind) VALUES (?, ?, ?) "
                                                   "ON CONFLICT (name) DO NOTHING"));
  VICTORIOUS_RETURN_IF_ERROR(put.Bind(model.name, model.model_id, model.kind).Run());
  VICTORIOUS_ASSIGN_OR_RETURN(Statement find, connection_->Prepare(std::string(kSelectModels) + "WHERE name = ?"));
  VICTORIOUS_RETURN_IF_ERROR(find.Bind(model.name).Step());
  ModelRecord stored = ReadModel(find);
  VICTORIOUS_RETURN_IF_ERROR(transaction.Commit());
  return stored;
}

Expected<std::vector<ModelRecord>> SqliteStore::Models() {
  VICTORIOUS_ASSIGN_OR_RETURN(Statement select, connection_->Prepare(std::string(kSelectModels) + "ORDER BY id"));
  return ReadAll(select, &ReadModel);
}

Expected<std::optional<SearchRecord>> SqliteStore::FindSearch(std::int64_t video, std::int64_t model) {
  VICTORIOUS_ASSIGN_OR_RETURN(
      Statement find, connection_->Prepare("SELECT s.next_frame, s.finished, o.json, s.program_version FROM searches s "
                                           "JOIN options o ON o.id = s.options WHERE s.video = ? AND s.model = ?"));
  VICTORIOUS_ASSIGN_OR_RETURN(const bool found, find.Bind(video, model).Step());
  if (!found) return std::nullopt;
  return SearchRecord{.video = video,
                      .model = model,
                      .next_frame = find.Integer(0),
                      .finished = find.Integer(1) != 0,
                      .options_json = find.Text(2),
                      .program_version = find.Text(3)};
}

Status SqliteStore::ForgetSearch(std::int64_t video, std::int64_t model) {
  VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_));
  for (const std::string_view sql : {"DELETE FROM objects WHERE video = ? AND model = ?",  // and their sightings
                                     "DELETE FROM searches WHERE video = ? AND model = ?"}) {
    VICTORIOUS_ASSIGN_OR_RETURN(Statement forget, connection_->Prepare(sql));
    VICTORIOUS_RETURN_IF_ERROR(forget.Bind(video, model).Run());
  }
  return transaction.Commit();
}

Status SqliteStore::ForgetKeptFrames(std::int64_t video) {
  VICTORIOUS_ASSIGN_OR_RETURN(Statement forget, connection_->Prepare("DELETE FROM frame_features WHERE video = ?"));
  return forget.Bind(video).Run();
}

Status SqliteStore::PutProgress(const IndexBatch::Progress& progress) {
  const SearchRecord& search = progress.search;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<SearchRecord> before, FindSearch(search.video, search.model));
  if ((before ? before->next_frame : 0) != progress.expected_next_frame) {
    return Fail(ErrorCode::kConflict,
                fmt::format("{}: another process is indexing the same video (it is at frame {}, this one was at {}): "
                            "let it finish, or stop it and run this again",
                            connection_->name(), before ? before->next_frame : 0, progress.expected_next_frame));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t options, PutOptions(search.options_json));
  VICTORIOUS_ASSIGN_OR_RETURN(
      Statement put, connection_->Prepare("INSERT OR REPLACE INTO searches (video, model, next_frame, finished, "
                                          "options, program_version) VALUES (?, ?, ?, ?, ?, ?)"));
  return put.Bind(search.video, search.model, search.next_frame, search.finished, options, search.program_version)
      .Run();
}

Expected<std::int64_t> SqliteStore::PutObject(const IndexBatch::ObjectUpdate& update) {
  const ObjectRecord& object = update.object;
  if (update.id) {
    VICTORIOUS_ASSIGN_OR_RETURN(Statement grow,
                                connection_->Prepare("UPDATE objects SET score = ?, frames = ?, first_time_s = ?, "
                                                     "last_time_s = ? WHERE id = ? AND video = ? AND model = ?"));
    grow.Bind(object.score, object.frames, object.first_time_s, object.last_time_s, *update.id, object.video,
              object.model);
    VICTORIOUS_RETURN_IF_ERROR(RunOnRow(grow, "object", *update.id));
    return *update.id;
  }
  VICTORIOUS_ASSIGN_OR_RETURN(Statement insert,
                              connection_->Prepare("INSERT INTO objects (video, model, score, frames, first_time_s, "
                                                   "last_time_s) VALUES (?, ?, ?, ?, ?, ?)"));
  VICTORIOUS_RETURN_IF_ERROR(
      insert.Bind(object.video, object.model, object.score, object.frames, object.first_time_s, object.last_time_s)
          .Run());
  return connection_->LastInsertId();
}

Status SqliteStore::PutSightings(const IndexBatch& batch, const std::vector<std::int64_t>& object_ids) {
  VICTORIOUS_ASSIGN_OR_RETURN(
      Statement insert,
      connection_->Prepare("INSERT INTO sightings (video, frame, object, time_s, box_x_px, box_y_px, box_width_px, "
                           "box_height_px, outline, score, source, matches, view_index, azimuth_rad, off_nadir_rad, "
                           "in_plane_rad) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)"));
  for (const auto& [update, s] : batch.sightings) {
    VICTORIOUS_CHECK(update < batch.objects.size());
    insert.Bind(batch.objects[update].object.video, s.frame, object_ids[update], s.time_s, s.box.x, s.box.y,
                s.box.width, s.box.height, OutlineBytes(s.outline), s.score, s.source, s.matches, s.view_index,
                std::nullopt, std::nullopt, s.in_plane_rad);
    if (s.view) {
      insert.BindAt(14, s.view->azimuth_rad);
      insert.BindAt(15, s.view->off_nadir_rad);
    }
    VICTORIOUS_RETURN_IF_ERROR(insert.Run());
  }
  return {};
}

Status SqliteStore::PutKeptFrames(const std::vector<KeptFrame>& frames) {
  VICTORIOUS_ASSIGN_OR_RETURN(
      Statement insert,
      connection_->Prepare("INSERT INTO frame_features (video, frame, time_s, image_width_px, image_height_px, "
                           "keypoints, descriptors) VALUES (?, ?, ?, ?, ?, ?, ?) "
                           "ON CONFLICT (video, frame) DO NOTHING"));
  for (const KeptFrame& kept : frames) {
    const FeatureSet& features = kept.features;
    VICTORIOUS_CHECK(features.descriptors.size() == features.size() * kDescriptorSize);
    insert.Bind(kept.video, kept.frame, kept.time_s, features.image_width, features.image_height,
                std::as_bytes(std::span(features.keypoints)), std::as_bytes(std::span(features.descriptors)));
    VICTORIOUS_RETURN_IF_ERROR(insert.Run());
  }
  return {};
}

Expected<std::vector<std::int64_t>> SqliteStore::Commit(const IndexBatch& batch) {
  VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_));
  for (const IndexBatch::Progress& progress : batch.progress) VICTORIOUS_RETURN_IF_ERROR(PutProgress(progress));
  std::vector<std::int64_t> object_ids;
  object_ids.reserve(batch.objects.size());
  for (const IndexBatch::ObjectUpdate& update : batch.objects) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t id, PutObject(update));
    object_ids.push_back(id);
  }
  VICTORIOUS_RETURN_IF_ERROR(PutSightings(batch, object_ids));
  VICTORIOUS_RETURN_IF_ERROR(PutKeptFrames(batch.kept_frames));
  VICTORIOUS_RETURN_IF_ERROR(transaction.Commit());
  return object_ids;
}

Expected<std::vector<ObjectRecord>> SqliteStore::Objects(const SightingFilter& filter) {
  Conditions conditions;
  VICTORIOUS_RETURN_IF_ERROR(AddVideos(*this, filter, "video", conditions));
  AddModel(filter, "model", conditions);
  AddTimes(filter, "first_time_s", "last_time_s", conditions);
  VICTORIOUS_ASSIGN_OR_RETURN(Statement select, connection_->Prepare(std::string(kSelectObjects) + conditions.text() +
                                                                     "ORDER BY score DESC, frames DESC, id"));
  conditions.Bind(select);
  return ReadAll(select, &ReadObject);
}

Status SqliteStore::VisitSightings(const SightingFilter& filter, const std::function<bool(SightingRecord&&)>& visit) {
  Conditions conditions;
  VICTORIOUS_RETURN_IF_ERROR(AddVideos(*this, filter, "s.video", conditions));
  AddModel(filter, "o.model", conditions);
  AddTimes(filter, "s.time_s", "s.time_s", conditions);
  VICTORIOUS_ASSIGN_OR_RETURN(Statement select, connection_->Prepare(std::string(kSelectSightings) + conditions.text() +
                                                                     "ORDER BY s.video, s.frame, s.object"));
  conditions.Bind(select);
  return VisitAll<SightingRecord>(select, connection_->name(), &ReadSighting, visit);
}

Status SqliteStore::VisitKeptFrames(const SightingFilter& filter, const std::function<bool(KeptFrame&&)>& visit) {
  Conditions conditions;
  VICTORIOUS_RETURN_IF_ERROR(AddVideos(*this, filter, "video", conditions));
  AddTimes(filter, "time_s", "time_s", conditions);
  VICTORIOUS_ASSIGN_OR_RETURN(Statement select, connection_->Prepare(std::string(kSelectKeptFrames) +
                                                                     conditions.text() + "ORDER BY video, frame"));
  conditions.Bind(select);
  return VisitAll<KeptFrame>(select, connection_->name(), &ReadKeptFrame, visit);
}

}  // namespace victorious::sqlite

namespace victorious {

Expected<std::unique_ptr<IndexStore>> OpenSqliteStore(const std::filesystem::path& path, StoreMode mode) {
  VICTORIOUS_ASSIGN_OR_RETURN(auto connection, sqlite::OpenDatabase(path, mode));
  return std::make_unique<sqlite::SqliteStore>(std::move(connection));
}

}  // namespace victorious

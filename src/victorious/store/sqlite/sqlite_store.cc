#include "victorious/store/sqlite/sqlite_store.h"

#include <fmt/format.h>

#include "victorious/base/check.h"
#include "victorious/store/sql/changed_objects.h"
#include "victorious/store/sql/filter_conditions.h"
#include "victorious/store/sql/records.h"
#include "victorious/store/sqlite/open_database.h"
#include "victorious/store/sqlite/page_checksums.h"

namespace victorious::sqlite {
namespace {

// Returns all rows of a query, converted by `read`.
template <typename Record>
Expected<std::vector<Record>> ReadAll(Statement& statement, Record (*read)(const sql::Row&)) {
  std::vector<Record> records;
  while (true) {
    VICTORIOUS_ASSIGN_OR_RETURN(const bool has_row, statement.Step());
    if (!has_row) return records;
    records.push_back(read(statement));
  }
}

// Likewise, for rows that can be damaged. `name`: the file's.
template <typename Record>
Expected<std::vector<Record>> ReadAll(Statement& statement, std::string_view name,
                                      Expected<Record> (*read)(const sql::Row&, std::string_view)) {
  std::vector<Record> records;
  while (true) {
    VICTORIOUS_ASSIGN_OR_RETURN(const bool has_row, statement.Step());
    if (!has_row) return records;
    VICTORIOUS_ASSIGN_OR_RETURN(Record record, read(statement, name));
    records.push_back(std::move(record));
  }
}

// Visits the rows of a query until the last one, or until `visit` returns false.
template <typename Record>
Status VisitAll(Statement& statement, std::string_view name,
                Expected<Record> (*read)(const sql::Row&, std::string_view),
                const std::function<bool(Record&&)>& visit) {
  while (true) {
    VICTORIOUS_ASSIGN_OR_RETURN(const bool has_row, statement.Step());
    if (!has_row) return {};
    VICTORIOUS_ASSIGN_OR_RETURN(Record record, read(statement, name));
    if (!visit(std::move(record))) return {};
  }
}

Status ForEachRow(Connection& connection, const std::string& query, const std::function<void(const sql::Row&)>& visit) {
  VICTORIOUS_ASSIGN_OR_RETURN(Statement select, connection.Prepare(query));
  while (true) {
    VICTORIOUS_ASSIGN_OR_RETURN(const bool has_row, select.Step());
    if (!has_row) return {};
    visit(select);
  }
}

// To be followed by conditions, then by kGroupObjects.
std::string SelectObjects() {
  return "SELECT " + sql::ObjectResultColumns() + ", group_concat(t.video_id), group_concat(t.id)" +
         std::string(sql::kFromObjects);
}

// All columns but the key and the model are replaced if the object exists.
std::string InsertOrUpdateObject() {
  return fmt::format(
      "INSERT INTO objects ({}) SELECT {} WHERE EXISTS (SELECT 1 FROM models WHERE id = ?{}) "
      "ON CONFLICT (id) DO UPDATE SET {}",
      sql::kObjectColumns.Names(), sql::kObjectColumns.Parameters(), sql::kObjectColumns.Parameter("model_id"),
      sql::kObjectColumns.Updates(sql::kObjectColumns.Index("place_time_s")));
}

}  // namespace

Status SqliteStore::ExecuteOnRow(Statement& statement, std::string_view what, std::int64_t id) {
  VICTORIOUS_RETURN_IF_ERROR(statement.Run());
  if (connection_->Changes() == 1) return {};
  return Fail(ErrorCode::kNotFound, fmt::format("{}: {} {} does not exist (another process may have deleted it)",
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
      connection_->Prepare(
          "INSERT INTO videos (content_id, name, folder, width_px, height_px, frame_count, duration_s, "
          "features_options_id, start_utc_us, is_of_photos, telemetry) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?) "
          "ON CONFLICT (content_id) DO UPDATE SET name = excluded.name, folder = excluded.folder, "
          "start_utc_us = CASE WHEN excluded.is_of_photos THEN NULL ELSE "
          "coalesce(excluded.start_utc_us, start_utc_us) END, "
          "is_of_photos = excluded.is_of_photos, "
          "telemetry = coalesce(nullif(excluded.telemetry, ''), telemetry)"));
  VICTORIOUS_RETURN_IF_ERROR(put.Bind(video.content_id, video.name, video.folder, video.width, video.height,
                                      video.frame_count, video.duration_s, features_options, video.start_utc_us,
                                      video.is_of_photos ? 1 : 0, video.telemetry)
                                 .Run());
  VICTORIOUS_ASSIGN_OR_RETURN(std::optional<VideoRecord> stored, VideoOfContent(video.content_id));
  VICTORIOUS_CHECK(stored.has_value());
  VICTORIOUS_RETURN_IF_ERROR(transaction.Commit());
  return *std::move(stored);
}

Expected<std::optional<VideoRecord>> SqliteStore::VideoOfContent(const std::string& content_id) {
  VICTORIOUS_ASSIGN_OR_RETURN(Statement find, connection_->Prepare(sql::SelectVideos() + "WHERE v.content_id = ?"));
  VICTORIOUS_ASSIGN_OR_RETURN(const bool found, find.Bind(content_id).Step());
  if (!found) return std::nullopt;
  return sql::ReadVideo(find);
}

Expected<std::int64_t> SqliteStore::DeleteOtherContent(const std::string& name, const std::string& folder,
                                                       const std::string& content_id) {
  // Deletes the dependent rows as well (ON DELETE CASCADE).
  VICTORIOUS_ASSIGN_OR_RETURN(
      Statement forget,
      connection_->Prepare("DELETE FROM videos WHERE name = ? AND folder IN ('', ?) AND content_id <> ?"));
  VICTORIOUS_RETURN_IF_ERROR(forget.Bind(name, folder, content_id).Run());
  return connection_->Changes();
}

Status SqliteStore::DeleteVideo(std::int64_t video) {
  return DeleteWithObjects("DELETE FROM videos WHERE id = ?", "video", video);
}

Status SqliteStore::DeleteModel(std::int64_t model) {
  return DeleteWithObjects("DELETE FROM models WHERE id = ?", "model", model);
}

// Deletes the dependent rows as well (ON DELETE CASCADE).
Status SqliteStore::DeleteWithObjects(std::string_view statement, const char* what, std::int64_t id) {
  VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_));
  {
    VICTORIOUS_ASSIGN_OR_RETURN(Statement remove, connection_->Prepare(statement));
    VICTORIOUS_RETURN_IF_ERROR(ExecuteOnRow(remove.Bind(id), what, id));
    VICTORIOUS_ASSIGN_OR_RETURN(Statement forget, connection_->Prepare(sql::kDeleteEmptyObjects));
    VICTORIOUS_RETURN_IF_ERROR(forget.Run());
  }
  return transaction.Commit();
}

Status SqliteStore::SetVideoLength(std::int64_t video, std::int64_t frame_count, double duration_s) {
  VICTORIOUS_ASSIGN_OR_RETURN(Statement update,
                              connection_->Prepare("UPDATE videos SET frame_count = ?, duration_s = ? WHERE id = ?"));
  update.Bind(frame_count, duration_s, video);
  return ExecuteOnRow(update, "video", video);
}

Status SqliteStore::PutShownGround(std::int64_t video, std::span<const GeoBox> boxes) {
  VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_));
  {
    VICTORIOUS_ASSIGN_OR_RETURN(Statement update,
                                connection_->Prepare("UPDATE videos SET has_shown_ground = 1 WHERE id = ?"));
    VICTORIOUS_RETURN_IF_ERROR(ExecuteOnRow(update.Bind(video), "video", video));
    VICTORIOUS_ASSIGN_OR_RETURN(Statement forget, connection_->Prepare("DELETE FROM shown_ground WHERE video_id = ?"));
    VICTORIOUS_RETURN_IF_ERROR(forget.Bind(video).Run());
    VICTORIOUS_ASSIGN_OR_RETURN(
        Statement insert, connection_->Prepare("INSERT INTO shown_ground (video_id, south_rad, west_rad, north_rad, "
                                               "east_rad) VALUES (?, ?, ?, ?, ?)"));
    for (const GeoBox& box : boxes) {
      VICTORIOUS_RETURN_IF_ERROR(insert.Bind(video, box.south_rad, box.west_rad, box.north_rad, box.east_rad).Run());
    }
  }
  return transaction.Commit();
}

Status SqliteStore::SetVideoFeatures(std::int64_t video, const std::string& features_json) {
  VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_));
  std::optional<std::int64_t> options;
  if (!features_json.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(options, PutOptions(features_json));
  }
  {
    VICTORIOUS_ASSIGN_OR_RETURN(Statement update,
                                connection_->Prepare("UPDATE videos SET features_options_id = ? WHERE id = ?"));
    update.Bind(options, video);
    VICTORIOUS_RETURN_IF_ERROR(ExecuteOnRow(update, "video", video));
  }
  return transaction.Commit();
}

Expected<std::vector<VideoRecord>> SqliteStore::Videos() {
  VICTORIOUS_ASSIGN_OR_RETURN(Statement select, connection_->Prepare(sql::SelectVideos() + "ORDER BY v.id"));
  return ReadAll(select, &sql::ReadVideo);
}

Expected<std::vector<VideoRecord>> SqliteStore::VideosNamed(const std::string& name) {
  VICTORIOUS_ASSIGN_OR_RETURN(Statement select,
                              connection_->Prepare(sql::SelectVideos() + "WHERE v.name = ? ORDER BY v.id"));
  select.Bind(name);
  return ReadAll(select, &sql::ReadVideo);
}

Expected<ModelRecord> SqliteStore::PutModel(const ModelRecord& model) {
  VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_));
  // Deletes other content of this name with its dependent rows (ON DELETE CASCADE).
  VICTORIOUS_ASSIGN_OR_RETURN(Statement replace,
                              connection_->Prepare("DELETE FROM models WHERE name = ? AND content_id <> ?"));
  VICTORIOUS_RETURN_IF_ERROR(replace.Bind(model.name, model.content_id).Run());
  VICTORIOUS_ASSIGN_OR_RETURN(Statement put,
                              connection_->Prepare("INSERT INTO models (name, content_id, kind) VALUES (?, ?, ?) "
                                                   "ON CONFLICT (name) DO NOTHING"));
  VICTORIOUS_RETURN_IF_ERROR(put.Bind(model.name, model.content_id, ToText(model.kind)).Run());
  VICTORIOUS_ASSIGN_OR_RETURN(Statement find, connection_->Prepare(sql::SelectModels() + "WHERE name = ?"));
  VICTORIOUS_RETURN_IF_ERROR(find.Bind(model.name).Step());
  VICTORIOUS_ASSIGN_OR_RETURN(ModelRecord stored, sql::ReadModel(find, connection_->name()));
  VICTORIOUS_RETURN_IF_ERROR(transaction.Commit());
  return stored;
}

Expected<std::vector<ModelRecord>> SqliteStore::Models() {
  VICTORIOUS_ASSIGN_OR_RETURN(Statement select, connection_->Prepare(sql::SelectModels() + "ORDER BY id"));
  return ReadAll(select, connection_->name(), &sql::ReadModel);
}

Expected<std::optional<SearchRecord>> SqliteStore::FindSearch(std::int64_t video, std::int64_t model) {
  VICTORIOUS_ASSIGN_OR_RETURN(Statement find, connection_->Prepare(sql::kFindSearch));
  VICTORIOUS_ASSIGN_OR_RETURN(const bool found, find.Bind(video, model).Step());
  if (!found) return std::nullopt;
  return sql::ReadSearch(find, video, model);
}

Expected<std::vector<SearchRecord>> SqliteStore::Searches() {
  VICTORIOUS_ASSIGN_OR_RETURN(Statement select, connection_->Prepare(sql::kSelectSearches));
  std::vector<SearchRecord> searches;
  while (true) {
    VICTORIOUS_ASSIGN_OR_RETURN(const bool has_row, select.Step());
    if (!has_row) return searches;
    searches.push_back(sql::ReadSearch(select, select.Integer(4), select.Integer(5)));
  }
}

Expected<std::vector<SearchPart>> SqliteStore::SearchParts(std::int64_t video) {
  VICTORIOUS_ASSIGN_OR_RETURN(Statement select,
                              connection_->Prepare(sql::SelectSearchParts(sql::Dialect::kSqlite, "WHERE video_id = ?") +
                                                   std::string(sql::kOrderSearchParts)));
  select.Bind(video);
  return ReadAll(select, connection_->name(), &sql::ReadSearchPart);
}

Status SqliteStore::DeleteSearch(std::int64_t video, std::int64_t model) {
  VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_));
  for (const std::string_view sql :
       {"DELETE FROM tracklets WHERE video_id = ? AND model_id = ?",  // cascades to their sightings
        "DELETE FROM searches WHERE video_id = ? AND model_id = ?"}) {
    VICTORIOUS_ASSIGN_OR_RETURN(Statement forget, connection_->Prepare(sql));
    VICTORIOUS_RETURN_IF_ERROR(forget.Bind(video, model).Run());
  }
  return transaction.Commit();
}

Status SqliteStore::DeleteKeptFrames(std::int64_t video) {
  VICTORIOUS_ASSIGN_OR_RETURN(Statement forget, connection_->Prepare("DELETE FROM kept_frames WHERE video_id = ?"));
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
      Statement put,
      connection_->Prepare("INSERT INTO searches (video_id, model_id, next_frame, finished, options_id, "
                           "program_version) VALUES (?, ?, ?, ?, ?, ?) ON CONFLICT (video_id, model_id) DO UPDATE SET "
                           "next_frame = excluded.next_frame, finished = excluded.finished, options_id = "
                           "excluded.options_id, program_version = excluded.program_version"));
  return put.Bind(search.video, search.model, search.next_frame, search.finished, options, search.program_version)
      .Run();
}

Status SqliteStore::JoinTracklets(const IndexBatch::JoinedTracklets& joined) {
  VICTORIOUS_CHECK(joined.into != joined.from);
  VICTORIOUS_ASSIGN_OR_RETURN(Statement move,
                              connection_->Prepare("UPDATE sightings SET tracklet_id = ? WHERE tracklet_id = ?"));
  VICTORIOUS_RETURN_IF_ERROR(move.Bind(joined.into, joined.from).Run());
  VICTORIOUS_ASSIGN_OR_RETURN(
      Statement count,
      connection_->Prepare("UPDATE tracklets AS t SET score = max(t.score, f.score), frames = t.frames + f.frames, "
                           "first_time_s = min(t.first_time_s, f.first_time_s), last_time_s = max(t.last_time_s, "
                           "f.last_time_s), revision = t.revision + 1 FROM tracklets f WHERE t.id = ? AND f.id = ? AND "
                           "f.video_id = t.video_id AND f.model_id = t.model_id"));
  count.Bind(joined.into, joined.from);
  VICTORIOUS_RETURN_IF_ERROR(ExecuteOnRow(count, "tracklet", joined.from));
  // The object of the second one remains if it has other tracklets.
  VICTORIOUS_ASSIGN_OR_RETURN(
      Statement forget,
      connection_->Prepare("DELETE FROM objects WHERE id = (SELECT object_id FROM tracklets WHERE id = ?) AND NOT "
                           "EXISTS (SELECT 1 FROM tracklets WHERE object_id = objects.id AND id <> ?)"));
  VICTORIOUS_ASSIGN_OR_RETURN(Statement remove, connection_->Prepare("DELETE FROM tracklets WHERE id = ?"));
  VICTORIOUS_RETURN_IF_ERROR(forget.Bind(joined.from, joined.from).Run());
  return remove.Bind(joined.from).Run();
}

Expected<std::int64_t> SqliteStore::PutTracklet(const IndexBatch::TrackletUpdate& update) {
  const TrackletRecord& tracklet = update.tracklet;
  if (update.id) {
    VICTORIOUS_ASSIGN_OR_RETURN(
        Statement grow, connection_->Prepare(
                            "UPDATE tracklets SET score = ?, frames = ?, first_time_s = ?, "
                            "last_time_s = ?, revision = revision + 1 WHERE id = ? AND video_id = ? AND model_id = ?"));
    grow.Bind(tracklet.score, tracklet.frames, tracklet.first_time_s, tracklet.last_time_s, *update.id, tracklet.video,
              tracklet.model);
    VICTORIOUS_RETURN_IF_ERROR(ExecuteOnRow(grow, "tracklet", *update.id));
    return *update.id;
  }
  VICTORIOUS_ASSIGN_OR_RETURN(Statement insert, connection_->Prepare(sql::kTrackletColumns.Insert("tracklets")));
  VICTORIOUS_RETURN_IF_ERROR(insert
                                 .Bind(tracklet.video, tracklet.model, tracklet.score, tracklet.frames,
                                       tracklet.first_time_s, tracklet.last_time_s)
                                 .Run());
  const std::int64_t id = connection_->LastInsertId();
  VICTORIOUS_ASSIGN_OR_RETURN(Statement found,
                              connection_->Prepare("INSERT INTO objects (id, model_id) VALUES (?, ?)"));
  VICTORIOUS_RETURN_IF_ERROR(found.Bind(id, tracklet.model).Run());
  VICTORIOUS_ASSIGN_OR_RETURN(Statement join, connection_->Prepare("UPDATE tracklets SET object_id = id WHERE id = ?"));
  VICTORIOUS_RETURN_IF_ERROR(join.Bind(id).Run());
  return id;
}

Status SqliteStore::PutSightings(const IndexBatch& batch, const std::vector<std::int64_t>& tracklet_ids) {
  VICTORIOUS_ASSIGN_OR_RETURN(Statement insert, connection_->Prepare(sql::kSightingColumns.Insert("sightings")));
  for (const auto& [update, sighting] : batch.sightings) {
    VICTORIOUS_CHECK(update < batch.tracklets.size());
    sql::BindSighting(sighting, batch.tracklets[update].tracklet.video, tracklet_ids[update], insert);
    VICTORIOUS_RETURN_IF_ERROR(insert.Run());
  }
  return {};
}

Status SqliteStore::PutKeptFrames(const std::vector<KeptFrame>& frames) {
  VICTORIOUS_ASSIGN_OR_RETURN(Statement insert, connection_->Prepare(sql::kKeptFrameColumns.Insert("kept_frames") +
                                                                     "ON CONFLICT (video_id, frame) DO NOTHING"));
  for (const KeptFrame& kept : frames) {
    const FeatureSet& features = kept.features;
    VICTORIOUS_CHECK(features.descriptors.size() == features.size() * kDescriptorSize);
    const std::vector<std::uint8_t> packed = sql::PackDescriptors(features.descriptors);
    insert.Bind(kept.video, kept.frame, kept.time_s, features.image_width, features.image_height,
                std::as_bytes(std::span(features.keypoints)), std::as_bytes(std::span(packed)));
    VICTORIOUS_RETURN_IF_ERROR(insert.Run());
  }
  return {};
}

Status SqliteStore::PutSearchParts(const std::vector<SearchPart>& parts) {
  for (const SearchPart& one : parts) {
    VICTORIOUS_ASSIGN_OR_RETURN(Statement put, connection_->Prepare(sql::kPutSearchPart));
    VICTORIOUS_RETURN_IF_ERROR(
        put.Bind(one.video, one.model, ToText(one.kind), one.from_frame, one.to_frame, one.from_s, one.to_s).Run());
  }
  return {};
}

Status SqliteStore::PutCoveredTimes(const std::vector<CoveredTime>& covered) {
  for (const CoveredTime& one : covered) {
    VICTORIOUS_ASSIGN_OR_RETURN(Statement put, connection_->Prepare(sql::kPutCoveredTime));
    VICTORIOUS_RETURN_IF_ERROR(put.Bind(one.video, one.from_frame, one.source, one.from_utc_us, one.to_utc_us).Run());
  }
  return {};
}

Expected<std::vector<CoveredTime>> SqliteStore::CoveredTimes(const std::string& source) {
  VICTORIOUS_ASSIGN_OR_RETURN(Statement select, connection_->Prepare(sql::kSelectCoveredTimes));
  select.Bind(source);
  return ReadAll(select, &sql::ReadCoveredTime);
}

Expected<std::vector<std::int64_t>> SqliteStore::Commit(const IndexBatch& batch) {
  VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_));
  for (const IndexBatch::Progress& progress : batch.progress) VICTORIOUS_RETURN_IF_ERROR(PutProgress(progress));
  for (const IndexBatch::JoinedTracklets& joined : batch.joined) VICTORIOUS_RETURN_IF_ERROR(JoinTracklets(joined));
  std::vector<std::int64_t> tracklet_ids;
  tracklet_ids.reserve(batch.tracklets.size());
  for (const IndexBatch::TrackletUpdate& update : batch.tracklets) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t id, PutTracklet(update));
    tracklet_ids.push_back(id);
  }
  VICTORIOUS_RETURN_IF_ERROR(PutSightings(batch, tracklet_ids));
  VICTORIOUS_RETURN_IF_ERROR(PutKeptFrames(batch.kept_frames));
  VICTORIOUS_RETURN_IF_ERROR(PutSearchParts(batch.parts));
  VICTORIOUS_RETURN_IF_ERROR(PutCoveredTimes(batch.covered));
  VICTORIOUS_RETURN_IF_ERROR(AssignReviewsOf(tracklet_ids));
  VICTORIOUS_RETURN_IF_ERROR(transaction.Commit());
  return tracklet_ids;
}

Expected<std::vector<TrackletRecord>> SqliteStore::Tracklets() {
  VICTORIOUS_ASSIGN_OR_RETURN(Statement select, connection_->Prepare(sql::SelectTracklets() + "ORDER BY id"));
  return ReadAll(select, &sql::ReadTracklet);
}

Status SqliteStore::PutObjects(std::span<const ObjectRecord> objects) {
  VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_));
  VICTORIOUS_RETURN_IF_ERROR(WriteObjects(objects));
  return transaction.Commit();
}

Status SqliteStore::UpdateObjects(const std::function<Expected<ObjectUpdate>()>& make, const CancelToken& /*cancel*/) {
  // A process that changes the index again and again meanwhile will itself update the objects.
  constexpr int kMaxTries = 3;
  for (int tries = 1;; ++tries) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t before, ChangeNumber());
    VICTORIOUS_ASSIGN_OR_RETURN(const ObjectUpdate update, make());
    VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_));
    VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t now, ChangeNumber());
    if (now != before && tries < kMaxTries) continue;
    VICTORIOUS_RETURN_IF_ERROR(WriteObjects(update.objects));
    VICTORIOUS_RETURN_IF_ERROR(DeleteFits(update.deleted_fits));
    VICTORIOUS_RETURN_IF_ERROR(WriteFits(update.put_fits));
    return transaction.Commit();
  }
}

Status SqliteStore::WriteObjects(std::span<const ObjectRecord> objects) {
  sql::ChangedObjects changed(objects);
  VICTORIOUS_RETURN_IF_ERROR(ForEachRow(*connection_, "SELECT " + sql::kObjectColumns.Names() + " FROM objects",
                                        [&](const sql::Row& row) { changed.Compare(row); }));
  VICTORIOUS_RETURN_IF_ERROR(ForEachRow(*connection_, "SELECT id, object_id FROM tracklets",
                                        [&](const sql::Row& row) { changed.CompareTracklet(row); }));
  {
    VICTORIOUS_ASSIGN_OR_RETURN(Statement put, connection_->Prepare(InsertOrUpdateObject()));
    VICTORIOUS_ASSIGN_OR_RETURN(
        Statement join,
        connection_->Prepare("UPDATE tracklets SET object_id = ? WHERE id = ? AND EXISTS (SELECT 1 FROM "
                             "objects WHERE id = ?)"));
    for (const ObjectRecord* object : changed.objects()) {
      sql::BindObject(*object, put);
      VICTORIOUS_RETURN_IF_ERROR(put.Run());
    }
    for (const auto& [tracklet, object] : changed.members())
      VICTORIOUS_RETURN_IF_ERROR(join.Bind(object, tracklet, object).Run());
  }
  VICTORIOUS_RETURN_IF_ERROR(
      connection_->Execute("DELETE FROM objects WHERE NOT EXISTS (SELECT 1 FROM tracklets WHERE object_id = "
                           "objects.id)"));
  // New sightings of the same objects: PutSightings has assigned their reviews.
  if (changed.objects().empty() && changed.members().empty()) return {};
  return AssignAllReviews();
}

Status SqliteStore::PutFits(std::span<const KeptFit> fits) {
  VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_));
  VICTORIOUS_RETURN_IF_ERROR(WriteFits(fits));
  return transaction.Commit();
}

Status SqliteStore::DeleteFits(std::span<const FitKey> fits) {
  VICTORIOUS_ASSIGN_OR_RETURN(Statement forget,
                              connection_->Prepare("DELETE FROM kept_fits WHERE tracklet_id = ? AND key = ?"));
  for (const auto& [tracklet, key] : fits) VICTORIOUS_RETURN_IF_ERROR(forget.Bind(tracklet, key).Run());
  return {};
}

Status SqliteStore::WriteFits(std::span<const KeptFit> fits) {
  VICTORIOUS_ASSIGN_OR_RETURN(
      Statement put,
      connection_->Prepare(fmt::format("INSERT INTO kept_fits ({}) SELECT ?1, ?2, ?3, ?4 WHERE EXISTS (SELECT 1 FROM "
                                       "tracklets WHERE id = ?1) ON CONFLICT (tracklet_id, key) DO UPDATE SET fit = "
                                       "excluded.fit, path = coalesce(excluded.path, path)",
                                       sql::kKeptFitColumns.Names())));
  for (const KeptFit& kept : fits) {
    sql::BindKeptFit(kept, put);
    VICTORIOUS_RETURN_IF_ERROR(put.Run());
  }
  return {};
}

Status SqliteStore::VisitKeptFits(const std::function<bool(KeptFit&&)>& visit) {
  VICTORIOUS_ASSIGN_OR_RETURN(Statement select, connection_->Prepare(sql::kSelectKeptFits));
  while (true) {
    VICTORIOUS_ASSIGN_OR_RETURN(const bool has_row, select.Step());
    if (!has_row || !visit(sql::ReadKeptFit(select))) return {};
  }
}

Expected<std::vector<std::byte>> SqliteStore::FindKeptPath(const FitKey& key) {
  VICTORIOUS_ASSIGN_OR_RETURN(Statement find, connection_->Prepare(sql::kFindKeptPath));
  VICTORIOUS_ASSIGN_OR_RETURN(const bool found, find.Bind(key.tracklet, key.key).Step());
  if (!found) return std::vector<std::byte>();
  const std::span<const std::byte> path = find.Blob(0);
  return std::vector<std::byte>(path.begin(), path.end());
}

Expected<std::vector<ObjectRecord>> SqliteStore::Objects(const SightingFilter& filter) {
  VICTORIOUS_ASSIGN_OR_RETURN(sql::Conditions conditions, sql::ObjectConditions(*this, filter, sql::Dialect::kSqlite));
  VICTORIOUS_ASSIGN_OR_RETURN(
      Statement select, connection_->Prepare(SelectObjects() + conditions.text() + std::string(sql::kGroupObjects)));
  conditions.Bind(select);
  std::vector<ObjectRecord> objects;
  VICTORIOUS_RETURN_IF_ERROR(
      VisitAll<ObjectRecord>(select, connection_->name(), &sql::ReadObject, [&](ObjectRecord&& object) {
        objects.push_back(std::move(object));
        return true;
      }));
  return objects;
}

Status SqliteStore::VisitSightings(const SightingFilter& filter, const std::function<bool(SightingRecord&&)>& visit) {
  // By video and tracklet, SQLite would read all sightings of the video, to save the sort. The "+" excludes the video
  // from the choice of the index, which leaves that of tracklets.
  SightingFilter indexed = filter;
  if (filter.tracklet) indexed.video.reset();
  VICTORIOUS_ASSIGN_OR_RETURN(sql::Conditions conditions,
                              sql::SightingConditions(*this, indexed, sql::Dialect::kSqlite));
  if (filter.tracklet && filter.video) conditions.Add("+s.video_id = ?", *filter.video);
  VICTORIOUS_ASSIGN_OR_RETURN(Statement select, connection_->Prepare(sql::SelectSightings() + conditions.text() +
                                                                     std::string(sql::kOrderSightings)));
  conditions.Bind(select);
  return VisitAll<SightingRecord>(select, connection_->name(), &sql::ReadSighting, visit);
}

Status SqliteStore::VisitKeptFrames(const SightingFilter& filter, const std::function<bool(KeptFrame&&)>& visit) {
  VICTORIOUS_ASSIGN_OR_RETURN(const sql::Conditions conditions, sql::KeptFrameConditions(*this, filter));
  VICTORIOUS_ASSIGN_OR_RETURN(Statement select, connection_->Prepare(sql::SelectKeptFrames() + conditions.text() +
                                                                     std::string(sql::kOrderKeptFrames)));
  conditions.Bind(select);
  return VisitAll<KeptFrame>(select, connection_->name(), &sql::ReadKeptFrame, visit);
}

Expected<std::vector<std::string>> SqliteStore::FindFaults() {
  std::vector<std::string> faults;
  constexpr std::size_t kMaxFaults = 100;  // the default number of messages of SQLite's own check
  VICTORIOUS_ASSIGN_OR_RETURN(Statement pages, connection_->Prepare("PRAGMA integrity_check"));
  while (true) {
    VICTORIOUS_ASSIGN_OR_RETURN(const bool row, pages.Step());
    if (!row) break;
    if (pages.Text(0) != "ok") faults.push_back(pages.Text(0));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(Statement references,
                              connection_->Prepare("SELECT \"table\", count(*), parent FROM pragma_foreign_key_check "
                                                   "GROUP BY \"table\", parent"));
  while (faults.size() < kMaxFaults) {
    VICTORIOUS_ASSIGN_OR_RETURN(const bool row, references.Step());
    if (!row) break;
    faults.push_back(fmt::format("rows of {} without their row of {}: {}", references.Text(0), references.Text(2),
                                 references.Integer(1)));
  }
  // Reads every value: what cannot be read is named by the error.
  const auto add = [&](const Status& status) {
    if (!status) faults.push_back(status.error().message);
  };
  const auto models = Models();
  const auto objects = Objects({.include_rejected = true});
  if (!models) faults.push_back(models.error().message);
  if (!objects) faults.push_back(objects.error().message);
  add(VisitSightings({.include_rejected = true}, [](SightingRecord&&) { return true; }));
  add(VisitKeptFrames({}, [](KeptFrame&&) { return true; }));
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
  VICTORIOUS_ASSIGN_OR_RETURN(auto connection, sqlite::OpenDatabase(path, mode));
  return std::make_unique<sqlite::SqliteStore>(std::move(connection));
}

}  // namespace victorious

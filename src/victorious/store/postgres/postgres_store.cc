#include "victorious/store/postgres/postgres_store.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <thread>

#include <fmt/format.h>

#include "victorious/base/check.h"
#include "victorious/store/postgres/migrations.h"
#include "victorious/store/sql/changed_objects.h"
#include "victorious/store/sql/dialect.h"
#include "victorious/store/sql/records.h"

namespace victorious::postgres {
namespace {

constexpr int kSightingsAtOnce = 2000;
constexpr int kFitsAtOnce = 10000;
constexpr int kKeptFramesAtOnce = 8;  // some 0.3 MB each

// Ids of a video's tracklets: those of one video lie below those of the next, whichever is indexed first.
constexpr std::int64_t kIdsPerVideo = 1'000'000'000;

// To be followed by conditions, then by kGroupObjects.
std::string SelectObjects() {
  return "SELECT " + sql::ObjectResultColumns() + ", string_agg(t.video_id::text, ','), string_agg(t.id::text, ',')" +
         std::string(sql::kFromObjects);
}

}  // namespace

Error PostgresStore::Missing(std::string_view what, std::int64_t id) const {
  return {ErrorCode::kNotFound,
          fmt::format("{}: {} {} does not exist (another process may have deleted it)", connection_->name(), what, id)};
}

Expected<std::int64_t> PostgresStore::PutOptions(const std::string& json) {
  const auto find = [&]() -> Expected<std::optional<std::int64_t>> {
    VICTORIOUS_ASSIGN_OR_RETURN(
        Result found, connection_->Query("SELECT id FROM options WHERE md5(json) = md5(?) AND json = ?", json, json));
    return found.Next() ? std::optional(found.Integer(0)) : std::nullopt;
  };
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<std::int64_t> known, find());
  if (known) return *known;
  VICTORIOUS_RETURN_IF_ERROR(
      connection_->Query("INSERT INTO options (json) VALUES (?) ON CONFLICT (md5(json)) DO NOTHING", json));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<std::int64_t> added, find());
  VICTORIOUS_CHECK(added.has_value());
  return *added;
}

Expected<ModelRecord> PostgresStore::PutModel(const ModelRecord& model) {
  const auto find = [&]() -> Expected<std::optional<ModelRecord>> {
    VICTORIOUS_ASSIGN_OR_RETURN(Result found, connection_->Query(sql::SelectModels() + "WHERE name = ?", model.name));
    if (!found.Next()) return std::nullopt;
    return sql::ReadModel(found, connection_->name());
  };
  VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_, Exclusion::kAll));
  VICTORIOUS_ASSIGN_OR_RETURN(std::optional<ModelRecord> stored, find());
  if (stored && stored->content_id != model.content_id) {
    // Deletes the dependent rows as well (ON DELETE CASCADE).
    VICTORIOUS_RETURN_IF_ERROR(connection_->Query("DELETE FROM models WHERE id = ?", stored->id));
    stored.reset();
  }
  if (!stored) {
    VICTORIOUS_RETURN_IF_ERROR(connection_->Query("INSERT INTO models (name, content_id, kind) VALUES (?, ?, ?)",
                                                  model.name, model.content_id, ToText(model.kind)));
    VICTORIOUS_ASSIGN_OR_RETURN(stored, find());
  }
  VICTORIOUS_RETURN_IF_ERROR(transaction.Commit());
  return *std::move(stored);
}

Expected<std::vector<ModelRecord>> PostgresStore::Models() {
  VICTORIOUS_ASSIGN_OR_RETURN(Result rows, connection_->Query(sql::SelectModels() + "ORDER BY id"));
  std::vector<ModelRecord> models;
  while (rows.Next()) {
    VICTORIOUS_ASSIGN_OR_RETURN(ModelRecord model, sql::ReadModel(rows, connection_->name()));
    models.push_back(std::move(model));
  }
  return models;
}

Expected<std::optional<SearchRecord>> PostgresStore::FindSearch(std::int64_t video, std::int64_t model) {
  VICTORIOUS_ASSIGN_OR_RETURN(Result found, connection_->Query(sql::kFindSearch, video, model));
  if (!found.Next()) return std::nullopt;
  return sql::ReadSearch(found, video, model);
}

Expected<std::vector<SearchRecord>> PostgresStore::Searches() {
  VICTORIOUS_ASSIGN_OR_RETURN(Result rows, connection_->Query(sql::kSelectSearches));
  std::vector<SearchRecord> searches;
  while (rows.Next()) searches.push_back(sql::ReadSearch(rows, rows.Integer(4), rows.Integer(5)));
  return searches;
}

Expected<std::vector<SearchPart>> PostgresStore::SearchParts(std::int64_t video) {
  VICTORIOUS_ASSIGN_OR_RETURN(Result rows,
                              connection_->Query(sql::SelectSearchParts(sql::Dialect::kPostgres, "WHERE video_id = ?") +
                                                     std::string(sql::kOrderSearchParts),
                                                 video, video));
  std::vector<SearchPart> parts;
  while (rows.Next()) {
    VICTORIOUS_ASSIGN_OR_RETURN(parts.emplace_back(), sql::ReadSearchPart(rows, connection_->name()));
  }
  return parts;
}

Status PostgresStore::DeleteSearch(std::int64_t video, std::int64_t model) {
  VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_, Exclusion::kAll));
  for (const std::string_view sql :
       {"DELETE FROM tracklets WHERE video_id = ? AND model_id = ?",  // cascades to their sightings
        "DELETE FROM searches WHERE video_id = ? AND model_id = ?"}) {
    VICTORIOUS_RETURN_IF_ERROR(connection_->Query(sql, video, model));
  }
  return transaction.Commit();
}

Status PostgresStore::DeleteKeptFrames(std::int64_t video) {
  VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_, Exclusion::kAll));
  VICTORIOUS_RETURN_IF_ERROR(connection_->Query("DELETE FROM kept_frames WHERE video_id = ?", video));
  return transaction.Commit();
}

Status PostgresStore::PutProgress(const IndexBatch::Progress& progress) {
  const SearchRecord& search = progress.search;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t options, PutOptions(search.options_json));
  // One statement, so that of two processes with the same progress one fails.
  VICTORIOUS_ASSIGN_OR_RETURN(
      const Result put,
      connection_->Query(
          "INSERT INTO searches (video_id, model_id, next_frame, finished, options_id, program_version) "
          "SELECT ?, ?, ?, ? <> 0, ?, ? WHERE ? = 0 OR EXISTS (SELECT 1 FROM searches WHERE video_id = ? AND "
          "model_id = ?) ON CONFLICT (video_id, model_id) DO UPDATE SET next_frame = excluded.next_frame, "
          "finished = excluded.finished, options_id = excluded.options_id, "
          "program_version = excluded.program_version WHERE searches.next_frame = ?",
          search.video, search.model, search.next_frame, int{search.finished}, options, search.program_version,
          progress.expected_next_frame, search.video, search.model, progress.expected_next_frame));
  if (put.Changes() == 1) return {};
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<SearchRecord> stored, FindSearch(search.video, search.model));
  return Fail(ErrorCode::kConflict,
              fmt::format("{}: another process is indexing the same video (it is at frame {}, this one was at {}): "
                          "let it finish, or stop it and run this again",
                          connection_->name(), stored ? stored->next_frame : 0, progress.expected_next_frame));
}

Status PostgresStore::LockObjectsOf(const std::vector<IndexBatch::TrackletUpdate>& updates) {
  std::vector<std::int64_t> known;
  for (const auto& [known_id, tracklet] : updates) {
    if (known_id) known.push_back(*known_id);
  }
  if (known.empty()) return {};
  VICTORIOUS_RETURN_IF_ERROR(connection_->Query(
      fmt::format("SELECT id FROM objects WHERE id IN (SELECT object_id FROM tracklets WHERE {}) ORDER BY id "
                  "FOR NO KEY UPDATE",
                  sql::IsOneOf(sql::Dialect::kPostgres, "id")),
      sql::ListText(sql::Dialect::kPostgres, known)));
  return {};
}

Status PostgresStore::JoinTracklets(const IndexBatch::JoinedTracklets& joined) {
  VICTORIOUS_CHECK(joined.into != joined.from);
  VICTORIOUS_RETURN_IF_ERROR(
      connection_->Query("SELECT id FROM objects WHERE id IN (SELECT object_id FROM tracklets WHERE id = ? OR id = ?) "
                         "ORDER BY id FOR UPDATE",
                         joined.into, joined.from));
  VICTORIOUS_RETURN_IF_ERROR(
      connection_->Query("UPDATE sightings SET tracklet_id = ? WHERE tracklet_id = ?", joined.into, joined.from));
  VICTORIOUS_ASSIGN_OR_RETURN(
      const Result counted,
      connection_->Query("UPDATE tracklets t SET score = greatest(t.score, f.score), frames = t.frames + f.frames, "
                         "first_time_s = least(t.first_time_s, f.first_time_s), last_time_s = greatest(t.last_time_s, "
                         "f.last_time_s), revision = t.revision + 1 FROM tracklets f WHERE t.id = ? AND f.id = ? AND "
                         "f.video_id = t.video_id AND f.model_id = t.model_id",
                         joined.into, joined.from));
  if (counted.Changes() != 1) return std::unexpected(Missing("tracklet", joined.from));
  // The object of the second one remains if it has other tracklets.
  VICTORIOUS_RETURN_IF_ERROR(
      connection_->Query("DELETE FROM objects o WHERE o.id = (SELECT object_id FROM tracklets WHERE id = ?) AND NOT "
                         "EXISTS (SELECT 1 FROM tracklets t WHERE t.object_id = o.id AND t.id <> ?)",
                         joined.from, joined.from));
  VICTORIOUS_RETURN_IF_ERROR(connection_->Query("DELETE FROM tracklets WHERE id = ?", joined.from));
  return {};
}

Expected<std::vector<std::int64_t>> PostgresStore::PutTracklets(
    const std::vector<IndexBatch::TrackletUpdate>& updates) {
  std::map<std::int64_t, std::int64_t> next_ids;  // by video
  for (const auto& [known_id, tracklet] : updates) {
    if (!known_id) ++next_ids[tracklet.video];
  }
  for (auto& [video, number] : next_ids) {
    VICTORIOUS_ASSIGN_OR_RETURN(Result made,
                                connection_->Query("UPDATE videos SET tracklets_made = tracklets_made + ? WHERE id = ? "
                                                   "RETURNING (id - 1) * ? + tracklets_made - ? + 1",
                                                   number, video, kIdsPerVideo, number));
    if (!made.Next()) return std::unexpected(Missing("video", video));
    number = made.Integer(0);
  }
  std::vector<std::int64_t> ids;
  CopyRows objects;
  CopyRows tracklets;
  for (const auto& [known_id, tracklet] : updates) {
    if (known_id) {
      VICTORIOUS_ASSIGN_OR_RETURN(
          const Result grown,
          connection_->Query("UPDATE tracklets SET score = ?, frames = ?, first_time_s = ?, last_time_s = ?, "
                             "revision = revision + 1 WHERE id = ? AND video_id = ? AND model_id = ?",
                             tracklet.score, tracklet.frames, tracklet.first_time_s, tracklet.last_time_s, *known_id,
                             tracklet.video, tracklet.model));
      if (grown.Changes() != 1) return std::unexpected(Missing("tracklet", *known_id));
      ids.push_back(*known_id);
    } else {
      ids.push_back(next_ids[tracklet.video]++);
      objects.AddRow(ids.back(), tracklet.model, tracklet.score, tracklet.frames, tracklet.first_time_s,
                     tracklet.last_time_s);
      tracklets.AddRow(tracklet.video, tracklet.model, tracklet.score, tracklet.frames, tracklet.first_time_s,
                       tracklet.last_time_s, ids.back(), ids.back());
    }
  }
  if (objects.IsEmpty()) return ids;
  VICTORIOUS_RETURN_IF_ERROR(
      connection_->Copy("objects (id, model_id, score, frames, first_time_s, last_time_s)", objects));
  VICTORIOUS_RETURN_IF_ERROR(
      connection_->Copy(fmt::format("tracklets ({}, id, object_id)", sql::kTrackletColumns.Names()), tracklets));
  return ids;
}

Status PostgresStore::PutSightings(const IndexBatch& batch, const std::vector<std::int64_t>& tracklet_ids) {
  if (batch.sightings.empty()) return {};
  CopyRows rows;
  for (const auto& [update, sighting] : batch.sightings) {
    VICTORIOUS_CHECK(update < batch.tracklets.size());
    BoundValues row;
    sql::BindSighting(sighting, batch.tracklets[update].tracklet.video, tracklet_ids[update], row);
    rows.Add(row);
  }
  return connection_->Copy(fmt::format("sightings ({})", sql::kSightingColumns.Names()), rows);
}

Status PostgresStore::PutKeptFrames(const std::vector<KeptFrame>& frames) {
  const std::string insert = sql::kKeptFrameColumns.Insert("kept_frames") + "ON CONFLICT (video_id, frame) DO NOTHING";
  for (const KeptFrame& kept : frames) {
    const FeatureSet& features = kept.features;
    VICTORIOUS_CHECK(features.descriptors.size() == features.size() * kDescriptorSize);
    const std::vector<std::uint8_t> packed = sql::PackDescriptors(features.descriptors);
    VICTORIOUS_RETURN_IF_ERROR(connection_->Query(insert, kept.video, kept.frame, kept.time_s, features.image_width,
                                                  features.image_height, std::as_bytes(std::span(features.keypoints)),
                                                  std::as_bytes(std::span(packed))));
  }
  return {};
}

Expected<std::vector<std::int64_t>> PostgresStore::Commit(const IndexBatch& batch) {
  VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_, Exclusion::kShared));
  for (const IndexBatch::Progress& progress : batch.progress) VICTORIOUS_RETURN_IF_ERROR(PutProgress(progress));
  for (const IndexBatch::JoinedTracklets& joined : batch.joined) VICTORIOUS_RETURN_IF_ERROR(JoinTracklets(joined));
  VICTORIOUS_RETURN_IF_ERROR(LockObjectsOf(batch.tracklets));
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<std::int64_t> tracklet_ids, PutTracklets(batch.tracklets));
  VICTORIOUS_RETURN_IF_ERROR(PutSightings(batch, tracklet_ids));
  VICTORIOUS_RETURN_IF_ERROR(PutKeptFrames(batch.kept_frames));
  for (const SearchPart& one : batch.parts) {
    VICTORIOUS_RETURN_IF_ERROR(connection_->Query(sql::kPutSearchPart, one.video, one.model, ToText(one.kind),
                                                  one.from_frame, one.to_frame, one.from_s, one.to_s));
  }
  for (const CoveredTime& one : batch.covered) {
    VICTORIOUS_RETURN_IF_ERROR(connection_->Query(sql::kPutCoveredTime, one.video, one.from_frame, one.source,
                                                  one.from_utc_us, one.to_utc_us));
  }
  VICTORIOUS_RETURN_IF_ERROR(AssignReviewsOf(tracklet_ids));
  VICTORIOUS_RETURN_IF_ERROR(transaction.Commit());
  return tracklet_ids;
}

Expected<std::vector<CoveredTime>> PostgresStore::CoveredTimes(const std::string& source) {
  VICTORIOUS_ASSIGN_OR_RETURN(Result rows, connection_->Query(sql::kSelectCoveredTimes, source));
  std::vector<CoveredTime> covered;
  while (rows.Next()) covered.push_back(sql::ReadCoveredTime(rows));
  return covered;
}

Expected<std::vector<TrackletRecord>> PostgresStore::Tracklets() {
  VICTORIOUS_ASSIGN_OR_RETURN(Result rows, connection_->Query(sql::SelectTracklets() + "ORDER BY id"));
  std::vector<TrackletRecord> tracklets;
  while (rows.Next()) tracklets.push_back(sql::ReadTracklet(rows));
  return tracklets;
}

Status PostgresStore::PutObjects(std::span<const ObjectRecord> objects) {
  VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_, Exclusion::kAll));
  VICTORIOUS_RETURN_IF_ERROR(WriteObjects(objects));
  return transaction.Commit();
}

Status PostgresStore::Write(const ObjectUpdate& update) {
  VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_, Exclusion::kAll));
  VICTORIOUS_RETURN_IF_ERROR(WriteObjects(update.objects));
  VICTORIOUS_RETURN_IF_ERROR(DeleteFits(update.deleted_fits));
  VICTORIOUS_RETURN_IF_ERROR(WriteFits(update.put_fits));
  return transaction.Commit();
}

Status PostgresStore::PutFits(std::span<const KeptFit> fits) {
  VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_, Exclusion::kAll));
  VICTORIOUS_RETURN_IF_ERROR(WriteFits(fits));
  return transaction.Commit();
}

Status PostgresStore::WriteObjects(std::span<const ObjectRecord> objects) {
  const std::string columns = sql::kObjectColumns.Names();
  sql::ChangedObjects changed(objects);
  {
    VICTORIOUS_ASSIGN_OR_RETURN(Result stored, connection_->Query("SELECT " + columns + " FROM objects"));
    while (stored.Next()) changed.Compare(stored);
    VICTORIOUS_ASSIGN_OR_RETURN(Result tracklets, connection_->Query("SELECT id, object_id FROM tracklets"));
    while (tracklets.Next()) changed.CompareTracklet(tracklets);
  }
  CopyRows object_rows;
  CopyRows member_rows;
  for (const ObjectRecord* object : changed.objects()) {
    BoundValues row;
    sql::BindObject(*object, row);
    object_rows.Add(row);
  }
  for (const auto& [tracklet, object] : changed.members()) member_rows.AddRow(object, tracklet);
  if (!object_rows.IsEmpty() || !member_rows.IsEmpty()) {
    VICTORIOUS_RETURN_IF_ERROR(connection_->Execute(
        fmt::format("CREATE TEMPORARY TABLE new_objects ON COMMIT DROP AS SELECT {} FROM objects WITH NO DATA; "
                    "CREATE TEMPORARY TABLE new_members (object_id bigint, tracklet_id bigint) ON COMMIT DROP",
                    columns)));
    VICTORIOUS_RETURN_IF_ERROR(connection_->Copy(fmt::format("new_objects ({})", columns), object_rows));
    VICTORIOUS_RETURN_IF_ERROR(connection_->Copy("new_members (object_id, tracklet_id)", member_rows));
    // All columns but the key and the model are replaced if the object exists.
    VICTORIOUS_RETURN_IF_ERROR(connection_->Execute(fmt::format(
        "ANALYZE new_objects, new_members; "
        "INSERT INTO objects ({0}) SELECT {0} FROM new_objects n WHERE EXISTS (SELECT 1 FROM models m WHERE m.id = "
        "n.model_id) ON CONFLICT (id) DO UPDATE SET {1}; "
        "UPDATE tracklets t SET object_id = n.object_id FROM new_members n JOIN objects o ON o.id = n.object_id "
        "WHERE t.id = n.tracklet_id",
        columns, sql::kObjectColumns.Updates(sql::kObjectColumns.Index("place_time_s")))));
  }
  VICTORIOUS_RETURN_IF_ERROR(connection_->Execute(
      "DELETE FROM objects o WHERE NOT EXISTS (SELECT 1 FROM tracklets t WHERE t.object_id = o.id)"));
  // New sightings of the same objects: Commit has assigned their reviews.
  return object_rows.IsEmpty() && member_rows.IsEmpty() ? Status() : AssignAllReviews();
}

Status PostgresStore::DeleteFits(std::span<const FitKey> fits) {
  if (fits.empty()) return {};
  CopyRows rows;
  for (const auto& [tracklet, key] : fits) rows.AddRow(tracklet, key);
  VICTORIOUS_RETURN_IF_ERROR(
      connection_->Execute("CREATE TEMPORARY TABLE old_fits (tracklet_id bigint, key bigint) ON COMMIT DROP"));
  VICTORIOUS_RETURN_IF_ERROR(connection_->Copy("old_fits (tracklet_id, key)", rows));
  return connection_->Execute(
      "ANALYZE old_fits; DELETE FROM kept_fits k USING old_fits o WHERE k.tracklet_id = o.tracklet_id AND k.key = "
      "o.key");
}

Status PostgresStore::WriteFits(std::span<const KeptFit> fits) {
  if (fits.empty()) return {};
  CopyRows rows;
  for (const KeptFit& kept : fits) {
    BoundValues row;
    sql::BindKeptFit(kept, row);
    rows.Add(row);
  }
  const std::string columns = sql::kKeptFitColumns.Names();
  VICTORIOUS_RETURN_IF_ERROR(connection_->Execute(
      fmt::format("CREATE TEMPORARY TABLE new_fits ON COMMIT DROP AS SELECT {} FROM kept_fits WITH NO DATA", columns)));
  VICTORIOUS_RETURN_IF_ERROR(connection_->Copy(fmt::format("new_fits ({})", columns), rows));
  return connection_->Execute(fmt::format(
      "INSERT INTO kept_fits ({0}) SELECT {0} FROM new_fits n WHERE EXISTS (SELECT 1 FROM tracklets t WHERE t.id = "
      "n.tracklet_id) ON CONFLICT (tracklet_id, key) DO UPDATE SET fit = excluded.fit, path = coalesce(excluded.path, "
      "kept_fits.path)",
      columns));
}

Status PostgresStore::VisitKeptFits(const std::function<bool(KeptFit&&)>& visit) {
  return connection_->Visit(sql::kSelectKeptFits, {}, kFitsAtOnce,
                            [&](const Result& row) -> Expected<bool> { return visit(sql::ReadKeptFit(row)); });
}

Expected<std::vector<std::byte>> PostgresStore::FindKeptPath(const FitKey& key) {
  VICTORIOUS_ASSIGN_OR_RETURN(Result row, connection_->Query(sql::kFindKeptPath, key.tracklet, key.key));
  if (!row.Next()) return std::vector<std::byte>();
  const std::span<const std::byte> path = row.Blob(0);
  return std::vector<std::byte>(path.begin(), path.end());
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
      status = Write(*update);
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

Expected<std::vector<ObjectRecord>> PostgresStore::Objects(const SightingFilter& filter) {
  VICTORIOUS_ASSIGN_OR_RETURN(const sql::Conditions conditions,
                              sql::ObjectConditions(*this, filter, sql::Dialect::kPostgres));
  BoundValues values;
  conditions.Bind(values);
  VICTORIOUS_ASSIGN_OR_RETURN(
      Result rows, connection_->Query(SelectObjects() + conditions.text() + std::string(sql::kGroupObjects), values));
  std::vector<ObjectRecord> objects;
  while (rows.Next()) {
    VICTORIOUS_ASSIGN_OR_RETURN(ObjectRecord object, sql::ReadObject(rows, connection_->name()));
    objects.push_back(std::move(object));
  }
  return objects;
}

Status PostgresStore::VisitSightings(const SightingFilter& filter, const std::function<bool(SightingRecord&&)>& visit) {
  VICTORIOUS_ASSIGN_OR_RETURN(sql::Conditions conditions,
                              sql::SightingConditions(*this, filter, sql::Dialect::kPostgres));
  // Of the parts of sightings, only those of the tracklets' videos are looked into.
  if (filter.object || filter.tracklet) conditions.Add("s.video_id = t.video_id");
  BoundValues values;
  conditions.Bind(values);
  return connection_->Visit(sql::SelectSightings() + conditions.text() + std::string(sql::kOrderSightings), values,
                            kSightingsAtOnce, [&](const Result& row) -> Expected<bool> {
                              VICTORIOUS_ASSIGN_OR_RETURN(SightingRecord sighting,
                                                          sql::ReadSighting(row, connection_->name()));
                              return visit(std::move(sighting));
                            });
}

Status PostgresStore::VisitKeptFrames(const SightingFilter& filter, const std::function<bool(KeptFrame&&)>& visit) {
  VICTORIOUS_ASSIGN_OR_RETURN(const sql::Conditions conditions, sql::KeptFrameConditions(*this, filter));
  BoundValues values;
  conditions.Bind(values);
  return connection_->Visit(sql::SelectKeptFrames() + conditions.text() + std::string(sql::kOrderKeptFrames), values,
                            kKeptFramesAtOnce, [&](const Result& row) -> Expected<bool> {
                              VICTORIOUS_ASSIGN_OR_RETURN(KeptFrame kept, sql::ReadKeptFrame(row, connection_->name()));
                              return visit(std::move(kept));
                            });
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
  // Reads every value: what cannot be read is named by the error.
  const auto status = [](const auto& read) -> Status {
    if (!read) return std::unexpected(read.error());
    return {};
  };
  VICTORIOUS_RETURN_IF_ERROR(add(status(Models())));
  VICTORIOUS_RETURN_IF_ERROR(add(status(Objects({.include_rejected = true}))));
  VICTORIOUS_RETURN_IF_ERROR(add(status(Reviews())));
  VICTORIOUS_RETURN_IF_ERROR(add(VisitSightings({.include_rejected = true}, [](SightingRecord&&) { return true; })));
  VICTORIOUS_RETURN_IF_ERROR(add(VisitKeptFrames({}, [](KeptFrame&&) { return true; })));
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

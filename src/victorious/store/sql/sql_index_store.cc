#include "victorious/store/sql/sql_index_store.h"

#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "victorious/base/check.h"
#include "victorious/store/sql/changed_objects.h"
#include "victorious/store/sql/conditions.h"
#include "victorious/store/sql/filter_conditions.h"
#include "victorious/store/sql/records.h"

namespace victorious::sql {
namespace {

// Visits the rows of a query that can be damaged until the last one, or until `visit` returns false.
template <typename Record>
Status VisitRecords(Database& database, const std::string& sql, const ValueList& values, RowCount rows,
                    Expected<Record> (*read)(const Row&, std::string_view),
                    const std::function<bool(Record&&)>& visit) {
  return database.Visit(sql, values, rows, [&](const Row& row) -> Expected<bool> {
    VICTORIOUS_ASSIGN_OR_RETURN(Record record, read(row, database.name()));
    return visit(std::move(record));
  });
}

// Locks the objects of tracklets in the order of their ids, so that two batches that change the same objects wait for
// each other, but not in a circle. Inside a transaction. One of SQLite excludes all others.
// @param lock  PostgreSQL's
Status LockObjectsOf(Database& database, std::span<const std::int64_t> tracklets, std::string_view lock) {
  if (database.dialect() == Dialect::kSqlite || tracklets.empty()) return {};
  return database.Visit(
      fmt::format("SELECT id FROM objects WHERE id IN (SELECT object_id FROM tracklets WHERE {}) ORDER BY id FOR {}",
                  IsOneOf(database.dialect(), "id"), lock),
      ValueList(ListText(database.dialect(), tracklets)), RowCount::kFew,
      [](const Row&) -> Expected<bool> { return true; });
}

Status PutProgress(Database& database, const IndexBatch::Progress& progress) {
  const SearchRecord& search = progress.search;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t options, PutOptions(database, search.options_json));
  // One statement, so that of two processes with the same progress one fails.
  VICTORIOUS_ASSIGN_OR_RETURN(
      const std::int64_t put,
      database.Write("INSERT INTO searches (video_id, model_id, next_frame, finished, options_id, program_version) "
                     "SELECT ?, ?, ?, ? <> 0, ?, ? WHERE ? = 0 OR EXISTS (SELECT 1 FROM searches WHERE video_id = ? "
                     "AND model_id = ?) ON CONFLICT (video_id, model_id) DO UPDATE SET "
                     "next_frame = excluded.next_frame, finished = excluded.finished, "
                     "options_id = excluded.options_id, program_version = excluded.program_version "
                     "WHERE searches.next_frame = ?",
                     ValueList(search.video, search.model, search.next_frame, int{search.finished}, options,
                               search.program_version, progress.expected_next_frame, search.video, search.model,
                               progress.expected_next_frame)));
  if (put == 1) return {};
  VICTORIOUS_ASSIGN_OR_RETURN(
      const std::int64_t frame,
      database.ReadInteger("SELECT next_frame FROM searches WHERE video_id = ? AND model_id = ?",
                           ValueList(search.video, search.model)));
  return Fail(ErrorCode::kConflict,
              fmt::format("{}: another process is indexing the same video (it is at frame {}, this one was at {}): "
                          "let it finish, or stop it and run this again",
                          database.name(), frame, progress.expected_next_frame));
}

Status JoinTracklets(Database& database, const IndexBatch::JoinedTracklets& joined) {
  VICTORIOUS_CHECK(joined.into != joined.from);
  const Dialect dialect = database.dialect();
  VICTORIOUS_RETURN_IF_ERROR(LockObjectsOf(database, std::vector<std::int64_t>{joined.into, joined.from}, "UPDATE"));
  VICTORIOUS_RETURN_IF_ERROR(database.Write("UPDATE sightings SET tracklet_id = ? WHERE tracklet_id = ?",
                                            ValueList(joined.into, joined.from)));
  VICTORIOUS_RETURN_IF_ERROR(WriteOne(
      database,
      fmt::format("UPDATE tracklets AS t SET score = {}, frames = t.frames + f.frames, first_time_s = {}, "
                  "last_time_s = {}, revision = t.revision + 1 FROM tracklets f WHERE t.id = ? AND f.id = ? AND "
                  "f.video_id = t.video_id AND f.model_id = t.model_id",
                  Greater(dialect, "t.score", "f.score"), Lesser(dialect, "t.first_time_s", "f.first_time_s"),
                  Greater(dialect, "t.last_time_s", "f.last_time_s")),
      ValueList(joined.into, joined.from), "tracklet", joined.from));
  // The object of the second one remains if it has other tracklets.
  VICTORIOUS_RETURN_IF_ERROR(
      database.Write("DELETE FROM objects WHERE id = (SELECT object_id FROM tracklets WHERE id = ?) AND NOT "
                     "EXISTS (SELECT 1 FROM tracklets WHERE object_id = objects.id AND id <> ?)",
                     ValueList(joined.from, joined.from)));
  VICTORIOUS_RETURN_IF_ERROR(database.Write("DELETE FROM tracklets WHERE id = ?", ValueList(joined.from)));
  return {};
}

Status PutSightings(Database& database, const IndexBatch& batch, const std::vector<std::int64_t>& tracklet_ids) {
  return database.InsertRows("sightings", kSightingColumns.Names(),
                             {.count = batch.sightings.size(), .bind = [&](std::size_t row, Parameters& values) {
                                const auto& [update, sighting] = batch.sightings[row];
                                VICTORIOUS_CHECK(update < batch.tracklets.size());
                                BindSighting(sighting, batch.tracklets[update].tracklet.video, tracklet_ids[update],
                                             values);
                              }});
}

Status PutKeptFrames(Database& database, const std::vector<KeptFrame>& frames) {
  return database.WriteRows(kKeptFrameColumns.Insert("kept_frames") + "ON CONFLICT (video_id, frame) DO NOTHING",
                            {.count = frames.size(), .bind = [&](std::size_t row, Parameters& values) {
                               const KeptFrame& kept = frames[row];
                               const FeatureSet& features = kept.features;
                               VICTORIOUS_CHECK(features.descriptors.size() == features.size() * kDescriptorSize);
                               const std::vector<std::uint8_t> packed = PackDescriptors(features.descriptors);
                               values.BindAll(kept.video, kept.frame, kept.time_s, features.image_width,
                                              features.image_height, std::as_bytes(std::span(features.keypoints)),
                                              std::as_bytes(std::span(packed)));
                             }});
}

Status PutSearchParts(Database& database, const std::vector<SearchPart>& parts) {
  return database.WriteRows(
      "INSERT INTO search_parts (video_id, model_id, kind, from_frame, to_frame, from_s, to_s) "
      "VALUES (?, ?, ?, ?, ?, ?, ?) ON CONFLICT (video_id, model_id, from_frame, kind) DO UPDATE SET "
      "to_frame = excluded.to_frame, from_s = excluded.from_s, to_s = excluded.to_s",
      {.count = parts.size(), .bind = [&](std::size_t row, Parameters& values) {
         const SearchPart& part = parts[row];
         values.BindAll(part.video, part.model, ToText(part.kind), part.from_frame, part.to_frame, part.from_s,
                        part.to_s);
       }});
}

Status PutCoveredTimes(Database& database, const std::vector<CoveredTime>& covered) {
  return database.WriteRows(
      "INSERT INTO covered_times (video_id, from_frame, source, from_utc_us, to_utc_us) VALUES (?, ?, ?, ?, ?) "
      "ON CONFLICT (video_id, from_frame) DO UPDATE SET from_utc_us = excluded.from_utc_us, "
      "to_utc_us = excluded.to_utc_us",
      {.count = covered.size(), .bind = [&](std::size_t row, Parameters& values) {
         const CoveredTime& time = covered[row];
         values.BindAll(time.video, time.from_frame, time.source, time.from_utc_us, time.to_utc_us);
       }});
}

Status DeleteFits(Database& database, std::span<const FitKey> fits) {
  return database.WriteFromRows(
      "kept_fits", "tracklet_id, key",
      {.count = fits.size(),
       .bind = [&](std::size_t row, Parameters& values) { values.BindAll(fits[row].tracklet, fits[row].key); }},
      "DELETE FROM kept_fits WHERE (tracklet_id, key) IN (SELECT tracklet_id, key FROM given)");
}

// Writes only what differs: most updates have the options of the one before.
Status PutAssociationOptions(Database& database, const std::string& json) {
  if (json.empty()) return {};
  VICTORIOUS_RETURN_IF_ERROR(
      database.Write("INSERT INTO association_options (id, json) VALUES (1, ?) ON CONFLICT (id) DO UPDATE SET "
                     "json = excluded.json WHERE association_options.json <> excluded.json",
                     ValueList(json)));
  return {};
}

}  // namespace

Error MissingRow(std::string_view name, std::string_view what, std::int64_t id) {
  return {ErrorCode::kNotFound,
          fmt::format("{}: {} {} does not exist (another process may have deleted it)", name, what, id)};
}

Status WriteOne(Database& database, const std::string& sql, const ValueList& values, std::string_view what,
                std::int64_t id) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t changed, database.Write(sql, values));
  if (changed == 1) return {};
  return std::unexpected(MissingRow(database.name(), what, id));
}

// PostgreSQL finds it by its checksum: an entry of its indexes is limited to 2.7 kB.
Expected<std::int64_t> PutOptions(Database& database, const std::string& json) {
  const std::string find =
      fmt::format("SELECT id FROM options, (SELECT CAST(? AS text) AS wanted) AS given WHERE {}json = wanted",
                  database.dialect() == Dialect::kPostgres ? "md5(json) = md5(wanted) AND " : "");
  const auto read = [](const Row& row) { return row.Integer(0); };
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<std::int64_t> known, database.ReadOne(find, ValueList(json), read));
  if (known) return *known;
  VICTORIOUS_RETURN_IF_ERROR(
      database.Write("INSERT INTO options (json) VALUES (?) ON CONFLICT DO NOTHING", ValueList(json)));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<std::int64_t> added, database.ReadOne(find, ValueList(json), read));
  VICTORIOUS_CHECK(added.has_value());
  return *added;
}

Expected<std::optional<SearchRecord>> SqlIndexStore::FindSearch(std::int64_t video, std::int64_t model) {
  return database_->ReadOne(SelectSearches() + "WHERE s.video_id = ? AND s.model_id = ?", ValueList(video, model),
                            ReadSearch);
}

Expected<std::vector<SearchRecord>> SqlIndexStore::Searches() {
  return database_->ReadAll(SelectSearches(), ValueList(), ReadSearch);
}

Expected<std::vector<SearchPart>> SqlIndexStore::SearchParts(std::int64_t video) {
  return database_->ReadAll(
      SelectSearchParts(database_->dialect()) + "WHERE video_id = ? " + std::string(kOrderSearchParts),
      ValueList(video), [&](const Row& row) { return ReadSearchPart(row, database_->name()); });
}

Status SqlIndexStore::DeleteSearch(std::int64_t video, std::int64_t model) {
  VICTORIOUS_ASSIGN_OR_RETURN(Change change, Change::Begin(*database_, Exclusion::kAll));
  // Cascades to their sightings.
  VICTORIOUS_RETURN_IF_ERROR(
      database_->Write("DELETE FROM tracklets WHERE video_id = ? AND model_id = ?", ValueList(video, model)));
  VICTORIOUS_RETURN_IF_ERROR(
      database_->Write("DELETE FROM searches WHERE video_id = ? AND model_id = ?", ValueList(video, model)));
  return change.Commit();
}

Status SqlIndexStore::DeleteKeptFrames(std::int64_t video) {
  VICTORIOUS_ASSIGN_OR_RETURN(Change change, Change::Begin(*database_, Exclusion::kAll));
  VICTORIOUS_RETURN_IF_ERROR(database_->Write("DELETE FROM kept_frames WHERE video_id = ?", ValueList(video)));
  return change.Commit();
}

Expected<std::vector<std::int64_t>> SqlIndexStore::PutTracklets(
    const std::vector<IndexBatch::TrackletUpdate>& updates) {
  std::map<std::int64_t, std::int64_t> next_ids;  // by video
  for (const auto& [known_id, tracklet] : updates) {
    if (!known_id) ++next_ids[tracklet.video];
  }
  if (!next_ids.empty()) VICTORIOUS_RETURN_IF_ERROR(ReserveTrackletIds(next_ids));
  std::vector<std::int64_t> ids;
  std::vector<std::size_t> added;  // positions in `updates`
  for (std::size_t i = 0; i < updates.size(); ++i) {
    const auto& [known_id, tracklet] = updates[i];
    if (!known_id) {
      added.push_back(i);
      ids.push_back(next_ids[tracklet.video]++);
      continue;
    }
    VICTORIOUS_RETURN_IF_ERROR(
        WriteOne(*database_,
                 "UPDATE tracklets SET score = ?, frames = ?, first_time_s = ?, last_time_s = ?, "
                 "revision = revision + 1 WHERE id = ? AND video_id = ? AND model_id = ?",
                 ValueList(tracklet.score, tracklet.frames, tracklet.first_time_s, tracklet.last_time_s, *known_id,
                           tracklet.video, tracklet.model),
                 "tracklet", *known_id));
    ids.push_back(*known_id);
  }
  VICTORIOUS_RETURN_IF_ERROR(
      database_->InsertRows("objects", "id, model_id, score, frames, first_time_s, last_time_s",
                            {.count = added.size(), .bind = [&](std::size_t row, Parameters& values) {
                               const TrackletRecord& tracklet = updates[added[row]].tracklet;
                               values.BindAll(ids[added[row]], tracklet.model, tracklet.score, tracklet.frames,
                                              tracklet.first_time_s, tracklet.last_time_s);
                             }}));
  VICTORIOUS_RETURN_IF_ERROR(
      database_->InsertRows("tracklets", kTrackletColumns.Names() + ", id, object_id",
                            {.count = added.size(), .bind = [&](std::size_t row, Parameters& values) {
                               const TrackletRecord& tracklet = updates[added[row]].tracklet;
                               const std::int64_t id = ids[added[row]];
                               values.BindAll(tracklet.video, tracklet.model, tracklet.score, tracklet.frames,
                                              tracklet.first_time_s, tracklet.last_time_s, id, id);
                             }}));
  return ids;
}

Expected<std::vector<std::int64_t>> SqlIndexStore::Commit(const IndexBatch& batch) {
  VICTORIOUS_ASSIGN_OR_RETURN(Change change, Change::Begin(*database_, Exclusion::kShared));
  for (const IndexBatch::Progress& progress : batch.progress) {
    VICTORIOUS_RETURN_IF_ERROR(PutProgress(*database_, progress));
  }
  for (const IndexBatch::JoinedTracklets& joined : batch.joined) {
    VICTORIOUS_RETURN_IF_ERROR(JoinTracklets(*database_, joined));
  }
  std::vector<std::int64_t> known;
  for (const auto& [known_id, tracklet] : batch.tracklets) {
    if (known_id) known.push_back(*known_id);
  }
  VICTORIOUS_RETURN_IF_ERROR(LockObjectsOf(*database_, known, "NO KEY UPDATE"));
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<std::int64_t> tracklet_ids, PutTracklets(batch.tracklets));
  VICTORIOUS_RETURN_IF_ERROR(PutSightings(*database_, batch, tracklet_ids));
  VICTORIOUS_RETURN_IF_ERROR(PutKeptFrames(*database_, batch.kept_frames));
  VICTORIOUS_RETURN_IF_ERROR(PutSearchParts(*database_, batch.parts));
  VICTORIOUS_RETURN_IF_ERROR(PutCoveredTimes(*database_, batch.covered));
  if (!tracklet_ids.empty()) VICTORIOUS_RETURN_IF_ERROR(AssignReviewsOf(tracklet_ids));
  VICTORIOUS_RETURN_IF_ERROR(change.Commit());
  return tracklet_ids;
}

Expected<std::vector<CoveredTime>> SqlIndexStore::CoveredTimes(const std::string& source) {
  return database_->ReadAll(
      "SELECT video_id, from_frame, source, from_utc_us, to_utc_us FROM covered_times WHERE source = ? "
      "ORDER BY from_utc_us, video_id",
      ValueList(source), ReadCoveredTime);
}

Expected<std::vector<TrackletRecord>> SqlIndexStore::Tracklets() {
  return database_->ReadAll(SelectTracklets() + "ORDER BY id", ValueList(), ReadTracklet);
}

Status SqlIndexStore::PutObjects(std::span<const ObjectRecord> objects) {
  VICTORIOUS_ASSIGN_OR_RETURN(Change change, Change::Begin(*database_, Exclusion::kAll));
  const std::string columns = kObjectColumns.Names();
  ChangedObjects changed(objects);
  VICTORIOUS_RETURN_IF_ERROR(database_->Visit(fmt::format("SELECT {} FROM objects", columns), ValueList(),
                                              RowCount::kFew, [&](const Row& row) -> Expected<bool> {
                                                changed.Compare(row);
                                                return true;
                                              }));
  VICTORIOUS_RETURN_IF_ERROR(database_->Visit("SELECT id, object_id FROM tracklets", ValueList(), RowCount::kFew,
                                              [&](const Row& row) -> Expected<bool> {
                                                changed.CompareTracklet(row);
                                                return true;
                                              }));
  const std::vector<const ObjectRecord*> differing = changed.objects();
  const std::vector<ChangedObjects::Member>& members = changed.members();
  // All columns but the key and the model are replaced if the object exists.
  VICTORIOUS_RETURN_IF_ERROR(database_->WriteFromRows(
      "objects", columns,
      {.count = differing.size(),
       .bind = [&](std::size_t row, Parameters& values) { BindObject(*differing[row], values); }},
      fmt::format("INSERT INTO objects ({0}) SELECT {0} FROM given WHERE EXISTS (SELECT 1 FROM models WHERE models.id "
                  "= given.model_id) ON CONFLICT (id) DO UPDATE SET {1}",
                  columns, kObjectColumns.Updates(kObjectColumns.Index("place_time_s")))));
  VICTORIOUS_RETURN_IF_ERROR(database_->WriteFromRows(
      "tracklets", "object_id, id",
      {.count = members.size(),
       .bind = [&](std::size_t row,
                   Parameters& values) { values.BindAll(members[row].object, members[row].tracklet); }},
      "UPDATE tracklets SET object_id = given.object_id FROM given JOIN objects ON objects.id = given.object_id "
      "WHERE tracklets.id = given.id"));
  VICTORIOUS_RETURN_IF_ERROR(database_->Write(std::string(kDeleteEmptyObjects), ValueList()));
  // New sightings of the same objects: Commit has assigned their reviews.
  if (!differing.empty() || !members.empty()) VICTORIOUS_RETURN_IF_ERROR(AssignAllReviews());
  return change.Commit();
}

Status SqlIndexStore::PutFits(std::span<const KeptFit> fits) {
  VICTORIOUS_ASSIGN_OR_RETURN(Change change, Change::Begin(*database_, Exclusion::kAll));
  VICTORIOUS_RETURN_IF_ERROR(database_->WriteFromRows(
      "kept_fits", kKeptFitColumns.Names(),
      {.count = fits.size(), .bind = [&](std::size_t row, Parameters& values) { BindKeptFit(fits[row], values); }},
      fmt::format("INSERT INTO kept_fits ({0}) SELECT {0} FROM given WHERE EXISTS (SELECT 1 FROM tracklets WHERE "
                  "tracklets.id = given.tracklet_id) ON CONFLICT (tracklet_id, key) DO UPDATE SET fit = excluded.fit, "
                  "path = coalesce(excluded.path, kept_fits.path)",
                  kKeptFitColumns.Names())));
  return change.Commit();
}

Status SqlIndexStore::WriteUpdate(const ObjectUpdate& update) {
  VICTORIOUS_ASSIGN_OR_RETURN(Change change, Change::Begin(*database_, Exclusion::kAll));
  VICTORIOUS_RETURN_IF_ERROR(PutObjects(update.objects));
  VICTORIOUS_RETURN_IF_ERROR(DeleteFits(*database_, update.deleted_fits));
  VICTORIOUS_RETURN_IF_ERROR(PutFits(update.put_fits));
  VICTORIOUS_RETURN_IF_ERROR(PutAssociationOptions(*database_, update.options_json));
  return change.Commit();
}

Expected<std::string> SqlIndexStore::AssociationOptions() {
  VICTORIOUS_ASSIGN_OR_RETURN(auto json, database_->ReadOne("SELECT json FROM association_options", ValueList(),
                                                            [](const Row& row) { return row.Text(0); }));
  return std::move(json).value_or(std::string());
}

Status SqlIndexStore::VisitKeptFits(const std::function<bool(KeptFit&&)>& visit) {
  return database_->Visit("SELECT tracklet_id, key, fit FROM kept_fits", ValueList(), RowCount::kMany,
                          [&](const Row& row) -> Expected<bool> { return visit(ReadKeptFit(row)); });
}

Expected<std::vector<std::byte>> SqlIndexStore::FindKeptPath(const FitKey& key) {
  VICTORIOUS_ASSIGN_OR_RETURN(auto path,
                              database_->ReadOne("SELECT path FROM kept_fits WHERE tracklet_id = ? AND key = ?",
                                                 ValueList(key.tracklet, key.key), [](const Row& row) {
                                                   const std::span<const std::byte> bytes = row.Blob(0);
                                                   return std::vector<std::byte>(bytes.begin(), bytes.end());
                                                 }));
  return std::move(path).value_or(std::vector<std::byte>());
}

Expected<std::vector<ObjectRecord>> SqlIndexStore::Objects(const SightingFilter& filter) {
  VICTORIOUS_ASSIGN_OR_RETURN(const Conditions conditions, ObjectConditions(*this, filter, database_->dialect()));
  return database_->ReadAll(SelectObjects(database_->dialect()) + conditions.text() + std::string(kGroupObjects),
                            ValuesOf(conditions), [&](const Row& row) { return ReadObject(row, database_->name()); });
}

Status SqlIndexStore::VisitSightings(const SightingFilter& filter, const std::function<bool(SightingRecord&&)>& visit) {
  VICTORIOUS_ASSIGN_OR_RETURN(const Conditions conditions, SightingConditions(*this, filter, database_->dialect()));
  return VisitRecords(*database_, SelectSightings() + conditions.text() + std::string(kOrderSightings),
                      ValuesOf(conditions), RowCount::kMany, &ReadSighting, visit);
}

Status SqlIndexStore::VisitKeptFrames(const SightingFilter& filter, const std::function<bool(KeptFrame&&)>& visit) {
  VICTORIOUS_ASSIGN_OR_RETURN(const Conditions conditions, KeptFrameConditions(*this, filter));
  return VisitRecords(*database_, SelectKeptFrames() + conditions.text() + std::string(kOrderKeptFrames),
                      ValuesOf(conditions), RowCount::kManyLarge, &ReadKeptFrame, visit);
}

Status SqlIndexStore::ReadEverything(const std::function<Status(const Status&)>& add) {
  const auto status = [](const auto& read) { return read ? Status() : Status(std::unexpected(read.error())); };
  VICTORIOUS_RETURN_IF_ERROR(add(status(Models())));
  VICTORIOUS_RETURN_IF_ERROR(add(status(Objects({.include_rejected = true}))));
  VICTORIOUS_RETURN_IF_ERROR(add(status(Reviews())));
  VICTORIOUS_RETURN_IF_ERROR(add(status(TrackletLinks())));
  VICTORIOUS_RETURN_IF_ERROR(add(VisitSightings({.include_rejected = true}, [](SightingRecord&&) { return true; })));
  return add(VisitKeptFrames({}, [](KeptFrame&&) { return true; }));
}

// Of PostgreSQL: the snapshot of a statement differs from an earlier one if any transaction of the server that writes
// began or ended between them, also one of another database.
Expected<std::int64_t> SqlIndexStore::ChangeNumber() {
  return database_->ReadInteger(database_->dialect() == Dialect::kSqlite
                                    ? "PRAGMA data_version"
                                    : "SELECT hashtextextended(pg_current_snapshot()::text, 0)",
                                ValueList());
}

}  // namespace victorious::sql

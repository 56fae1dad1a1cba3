// Tests specific to SQLite files: application id, schema version, damage, full disk, killed writer, read-only folder.
#include "victorious/store/sqlite/sqlite_store.h"

#include <array>
#include <csignal>
#include <fstream>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "testing/data.h"
#include "victorious/base/file.h"
#include "victorious/store/sqlite/migrations.h"

namespace victorious::sqlite {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

constexpr int kSightingsInBatch = 20;

std::unique_ptr<IndexStore> OpenOrDie(const fs::path& path, StoreMode mode = StoreMode::kCreate) {
  auto store = OpenSqliteStore(path, mode);
  if (!store) ADD_FAILURE() << store.error().message;
  return store ? *std::move(store) : nullptr;
}

Error OpenError(const fs::path& path, StoreMode mode) {
  const auto store = OpenSqliteStore(path, mode);
  EXPECT_FALSE(store) << "opened";
  return store ? Error{} : store.error();
}

// A new object with sightings in the frames [first, first + kSightingsInBatch), and the corresponding progress.
IndexBatch Batch(std::int64_t video, std::int64_t model, std::int64_t first) {
  IndexBatch batch;
  batch.tracklets.push_back(
      {std::nullopt, {.video = video, .model = model, .score = 0.5, .frames = kSightingsInBatch}});
  for (int i = 0; i < kSightingsInBatch; ++i) {
    batch.sightings.push_back({0, {.frame = first + i, .outline = {{0, 0}, {9, 0}, {9, 9}}, .score = 0.5}});
  }
  batch.progress.push_back(
      {{.video = video, .model = model, .next_frame = first + kSightingsInBatch, .options_json = "{}"}, first});
  return batch;
}

// Commits batches from the index's progress up to frame `end` or the first error.
Status CommitBatches(const fs::path& path, std::int64_t end) {
  VICTORIOUS_ASSIGN_OR_RETURN(const auto store, OpenSqliteStore(path, StoreMode::kCreate));
  VICTORIOUS_ASSIGN_OR_RETURN(const VideoRecord video, store->PutVideo({.content_id = "c", .name = "a.mp4"}));
  VICTORIOUS_ASSIGN_OR_RETURN(const ModelRecord model,
                              store->PutModel({.name = "m", .content_id = "1", .kind = ModelKind::kPhotos}));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto search, store->FindSearch(video.id, model.id));
  for (std::int64_t frame = search ? search->next_frame : 0; frame < end; frame += kSightingsInBatch) {
    VICTORIOUS_RETURN_IF_ERROR(store->Commit(Batch(video.id, model.id, frame)));
  }
  return {};
}

// Returns the stored sightings, which must be those of whole batches, consistent with the progress.
std::int64_t CountWholeBatches(IndexStore& store) {
  const auto sightings = store.Sightings({});
  EXPECT_TRUE(sightings) << sightings.error().message;
  const auto search = store.FindSearch(1, 1);
  EXPECT_TRUE(search) << search.error().message;
  const std::int64_t done = search && *search ? (*search)->next_frame : 0;
  EXPECT_EQ(static_cast<std::int64_t>(sightings->size()), done);
  EXPECT_EQ(static_cast<std::int64_t>(store.Objects({})->size()), done / kSightingsInBatch);
  return done;
}

std::string IntegrityCheck(const fs::path& path) {
  const auto connection = Connection::Open(path, Access::kWrite);
  return connection ? (*connection)->QueryText("PRAGMA integrity_check").value_or("failed") : "not opened";
}

// Returns the number of sightings in the index so far; 0 while another process is creating it.
std::int64_t StoredSightings(const fs::path& path) {
  if (!fs::exists(path)) return 0;
  const auto reader = OpenSqliteStore(path, StoreMode::kRead);
  if (!reader) return 0;
  const auto sightings = (*reader)->Sightings({});
  return sightings ? static_cast<std::int64_t>(sightings->size()) : 0;
}

// Runs `body` in a child process. Returns its exit status (the result of `body`); -1 if a signal ended it.
template <typename Body>
int InChild(Body body) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(body());
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

// For a child process: returns 0 if `result` failed with `code`; prints any other result to stderr.
template <typename Result>
int ExpectError(const Result& result, ErrorCode code) {
  if (!result && result.error().code == code) return 0;
  std::fprintf(stderr, "%s\n", result ? "no error" : result.error().message.c_str());
  return 1;
}

// Runs `body` as user nobody if this process is root.
template <typename Body>
int WithoutRights(Body body) {
  return InChild([&] {
    constexpr uid_t kNobody = 65534;
    if (::geteuid() == 0 && ::seteuid(kNobody) != 0) return 100;
    return body();
  });
}

std::vector<std::string> FilesIn(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename().string());
  std::ranges::sort(names);
  return names;
}

void MakeReadOnly(const fs::path& folder) {
  for (const auto& entry : fs::directory_iterator(folder)) fs::permissions(entry, fs::perms(0444));
  fs::permissions(folder, fs::perms(0555));
}

class SqliteStoreTest : public ::testing::Test {
 protected:
  ~SqliteStoreTest() override { fs::permissions(folder_.path(), fs::perms(0755)); }

  testing::ScratchFolder folder_;
  fs::path path_ = folder_ / "a?b %41.db";  // a name with characters that are special in a URI
};

TEST_F(SqliteStoreTest, ReadingCreatesNoFile) {
  EXPECT_EQ(OpenError(path_, StoreMode::kRead).code, ErrorCode::kNotFound);
  EXPECT_TRUE(FilesIn(folder_.path()).empty());
  ASSERT_TRUE(CommitBatches(path_, 40));
  const auto store = OpenOrDie(path_, StoreMode::kRead);
  EXPECT_EQ(CountWholeBatches(*store), 40);
  EXPECT_EQ(store->DeleteSearch(1, 1).error().code, ErrorCode::kPermissionDenied);
}

TEST_F(SqliteStoreTest, ReadingDoesNotChangeTheFolder) {
  ASSERT_TRUE(CommitBatches(path_, 20));
  EXPECT_EQ(FilesIn(folder_.path()).size(), 1u);
  CountWholeBatches(*OpenOrDie(path_, StoreMode::kRead));
  EXPECT_EQ(FilesIn(folder_.path()).size(), 1u);
}

TEST_F(SqliteStoreTest, EmptyFileIsNewForWritersAndAnErrorForReaders) {
  std::ofstream(path_).flush();
  EXPECT_EQ(OpenError(path_, StoreMode::kRead).code, ErrorCode::kDataLoss);
  EXPECT_EQ(fs::file_size(path_), 0u);
  EXPECT_TRUE(CommitBatches(path_, 20));
}

TEST_F(SqliteStoreTest, RefusesNonDatabases) {
  std::ofstream(path_) << "This is the text of a letter, and it is long enough to be read as a header. "
                       << std::string(4096, 'x');
  for (const StoreMode mode : {StoreMode::kCreate, StoreMode::kRead}) {
    const Error error = OpenError(path_, mode);
    EXPECT_EQ(error.code, ErrorCode::kDataLoss);
    EXPECT_THAT(error.message, HasSubstr("not an index"));
    EXPECT_EQ(error.message.find('\n'), std::string::npos);
  }
}

TEST_F(SqliteStoreTest, RefusesFoldersAndMissingFolders) {
  EXPECT_EQ(OpenError(folder_.path(), StoreMode::kRead).code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(OpenError(folder_.path(), StoreMode::kCreate).code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(OpenError("", StoreMode::kCreate).code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(OpenError(folder_ / "none/index.db", StoreMode::kCreate).code, ErrorCode::kNotFound);
}

TEST_F(SqliteStoreTest, RefusesForeignDatabasesUnchanged) {
  {
    const auto connection = Connection::Open(path_, Access::kCreate);
    ASSERT_TRUE((*connection)->Execute("CREATE TABLE notes (text); PRAGMA user_version = 3"));
  }
  const std::string before = *ReadFile(path_);
  for (const StoreMode mode : {StoreMode::kCreate, StoreMode::kRead}) {
    const Error error = OpenError(path_, mode);
    EXPECT_EQ(error.code, ErrorCode::kUnsupported);
    EXPECT_THAT(error.message, HasSubstr("another program"));
  }
  EXPECT_EQ(*ReadFile(path_), before);
}

TEST_F(SqliteStoreTest, RefusesANewerVersion) {
  ASSERT_TRUE(CommitBatches(path_, 20));
  ASSERT_TRUE((*Connection::Open(path_, Access::kWrite))->Execute("PRAGMA user_version = 99"));
  for (const StoreMode mode : {StoreMode::kCreate, StoreMode::kRead}) {
    const Error error = OpenError(path_, mode);
    EXPECT_EQ(error.code, ErrorCode::kUnsupported);
    EXPECT_THAT(error.message, HasSubstr("written by a newer version (schema 99; this program reads up to 7)"));
  }
}

TEST_F(SqliteStoreTest, IndexWithoutTablesIsDataLoss) {
  ASSERT_TRUE(CommitBatches(path_, 20));
  ASSERT_TRUE((*Connection::Open(path_, Access::kWrite))->Execute("DROP TABLE sightings"));
  const auto store = OpenOrDie(path_, StoreMode::kRead);
  EXPECT_EQ(store->Sightings({}).error().code, ErrorCode::kDataLoss);
}

TEST_F(SqliteStoreTest, DamagedBytesNeverCrash) {
  ASSERT_TRUE(CommitBatches(path_, 2000));
  const std::string whole = *ReadFile(path_);
  int refused = 0;
  for (std::size_t at = 0; at < whole.size(); at += 997) {
    std::string damaged = whole;
    for (std::size_t i = at; i < std::min(at + 64, damaged.size()); ++i)
      damaged[i] = static_cast<char>(damaged[i] ^ 0x5A);
    ASSERT_TRUE(WriteFileAtomically(path_, damaged));
    const auto store = OpenSqliteStore(path_, StoreMode::kRead);
    const auto sightings = store ? (*store)->Sightings({}) : std::unexpected(store.error());
    if (!sightings) {
      ++refused;
      EXPECT_NE(sightings.error().code, ErrorCode::kInvalidArgument) << sightings.error().message;
    }
  }
  EXPECT_GT(refused, 0);
}

TEST_F(SqliteStoreTest, FaultsAreFound) {
  const auto store = OpenSqliteStore(path_, StoreMode::kCreate).value();
  const VideoRecord video = store->PutVideo({.content_id = "c", .name = "a.mp4"}).value();
  IndexBatch batch;
  batch.kept_frames.push_back({.video = video.id, .frame = 0});
  batch.kept_frames.back().features = {
      .keypoints = {{1, 2, 3, 0}}, .descriptors = {}, .image_width = 9, .image_height = 9};
  batch.kept_frames.back().features.descriptors.resize(kDescriptorSize, 7);
  ASSERT_TRUE(store->Commit(batch));
  EXPECT_THAT(store->FindFaults().value(), ::testing::IsEmpty());
  const auto connection = Connection::Open(path_, Access::kWrite).value();
  ASSERT_TRUE(
      connection->Execute("PRAGMA foreign_keys = OFF; UPDATE kept_frames SET descriptors = x'0102'; "
                          "INSERT INTO searches (video_id, model_id, next_frame, finished, options_id, "
                          "program_version) VALUES (7, 8, 0, 0, 9, '')"));
  const std::vector<std::string> faults = store->FindFaults().value();
  EXPECT_THAT(faults, ::testing::Contains(HasSubstr("rows of searches without their row of models: 1")));
  EXPECT_THAT(faults, ::testing::Contains(HasSubstr("descriptors")));
}

// An index of schema 7 does not know the folders of its videos.
TEST_F(SqliteStoreTest, MigratesIndexOfVersion7) {
  {
    const auto connection = Connection::Open(path_, Access::kCreate).value();
    ASSERT_TRUE(Migrate(*connection, Migrations().first(7)));
    ASSERT_TRUE(connection->Execute(
        "INSERT INTO videos (content_id, name, width_px, height_px) VALUES ('c', 'flights/a.mp4', 640, 480)"));
  }
  const auto store = OpenSqliteStore(path_, StoreMode::kCreate).value();
  EXPECT_EQ(store->Videos().value().front().folder, "");
  EXPECT_EQ(store->PutVideo({.content_id = "c", .name = "a.mp4", .folder = "/data/flights"}).value().folder,
            "/data/flights");
}

TEST_F(SqliteStoreTest, TruncatedFileIsDataLoss) {
  ASSERT_TRUE(CommitBatches(path_, 2000));
  fs::resize_file(path_, fs::file_size(path_) / 2);
  const Error error = OpenError(path_, StoreMode::kRead);
  EXPECT_EQ(error.code, ErrorCode::kDataLoss);
  EXPECT_THAT(error.message, HasSubstr("damaged"));
}

TEST_F(SqliteStoreTest, MigrationsAreAppliedInOrderOnce) {
  ASSERT_TRUE(CommitBatches(path_, 20));
  std::vector<Migration> migrations(Migrations().begin(), Migrations().end());
  const int next = static_cast<int>(migrations.size()) + 1;
  migrations.push_back({next, "ALTER TABLE videos ADD COLUMN place TEXT"});
  const auto connection = Connection::Open(path_, Access::kWrite);
  for (int i = 0; i < 2; ++i) {
    const Status status = Migrate(**connection, migrations);
    ASSERT_TRUE(status) << status.error().message;
    EXPECT_EQ(*ReadVersion(**connection, next), next);
  }
  EXPECT_EQ(*(*connection)->QueryText("SELECT count(*) FROM videos WHERE place IS NULL"), "1");
  EXPECT_EQ(OpenError(path_, StoreMode::kCreate).code, ErrorCode::kUnsupported);
}

TEST_F(SqliteStoreTest, FailedMigrationChangesNothing) {
  ASSERT_TRUE(CommitBatches(path_, 20));
  std::vector<Migration> migrations(Migrations().begin(), Migrations().end());
  migrations.push_back(
      {static_cast<int>(migrations.size()) + 1, "ALTER TABLE videos ADD COLUMN place TEXT; DROP TABLE none"});
  EXPECT_FALSE(Migrate(**Connection::Open(path_, Access::kWrite), migrations));
  EXPECT_EQ(CountWholeBatches(*OpenOrDie(path_)), 20);
}

// An index of schema 1, written by program 0.1.0: its objects become tracklets and objects with the same ids.
TEST_F(SqliteStoreTest, MigratesIndexOfVersion1) {
  {
    const auto connection = Connection::Open(path_, Access::kCreate);
    ASSERT_TRUE(Migrate(**connection, Migrations().first(1)));
    ASSERT_TRUE(
        (*connection)
            ->Execute(
                "INSERT INTO videos (content_id, name, width_px, height_px) VALUES ('c', 'a.mp4', 640, 480);"
                "INSERT INTO models (name, model_id, kind) VALUES ('m', '1', 'photos');"
                "INSERT INTO objects (id, video, model, score, frames, first_time_s, last_time_s) VALUES "
                "(4, 1, 1, 0.9, 1, 0, 0), (7, 1, 1, 0.5, 1, 1, 1), (9, 1, 1, 0.4, 0, 0, 0);"
                "INSERT INTO sightings (video, frame, object, time_s, box_x_px, box_y_px, box_width_px, box_height_px, "
                "outline, score, source, matches, view_index, in_plane_rad) VALUES "
                "(1, 0, 4, 0, 1, 2, 3, 4, x'', 0.9, 'recognised', 5, 0, 0), (1, 10, 7, 1, 1, 2, 3, 4, x'', 0.5, "
                "'recognised', "
                "5, 0, 0); DELETE FROM objects WHERE id = 9"));
  }
  EXPECT_EQ(OpenError(path_, StoreMode::kRead).code, ErrorCode::kUnsupported) << "reading changes nothing";
  const auto store = OpenOrDie(path_);
  const auto objects = store->Objects({});
  ASSERT_EQ(objects->size(), 2U);
  EXPECT_EQ(objects->front().id, 4);
  EXPECT_EQ(objects->front().frames, 1);
  EXPECT_FALSE(objects->front().place);
  const auto sightings = store->Sightings({});
  ASSERT_EQ(sightings->size(), 2U);
  EXPECT_EQ(sightings->back().object, 7);
  EXPECT_FALSE(sightings->back().observation);
  EXPECT_FALSE(sightings->back().distance_m);
  const auto ids = store->Commit(Batch(1, 1, 0));
  ASSERT_TRUE(ids) << ids.error().message;
  EXPECT_EQ(ids->front(), 10) << "ids are unique";
  EXPECT_EQ(IntegrityCheck(path_), "ok");
}

// An index of schema 2: its sightings have the matched views; the distances of the objects are unknown.
TEST_F(SqliteStoreTest, MigratesIndexOfVersion2) {
  {
    const auto connection = Connection::Open(path_, Access::kCreate);
    ASSERT_TRUE(Migrate(**connection, Migrations().first(2)));
    ASSERT_TRUE((*connection)
                    ->Execute("INSERT INTO videos (content_id, name, width_px, height_px) VALUES ('c', 'a.mp4', 640, "
                              "480); INSERT INTO models (name, model_id, kind) VALUES ('m', '1', 'cad');"
                              "INSERT INTO objects (id, model) VALUES (1, 1);"
                              "INSERT INTO runs (id, object, video, model, score, frames, first_time_s, last_time_s) "
                              "VALUES (1, 1, 1, 1, 0.9, 1, 0, 0);"
                              "INSERT INTO sightings (video, frame, run, time_s, box_x_px, box_y_px, box_width_px, "
                              "box_height_px, outline, score, source, matches, view_index, azimuth_rad, "
                              "off_nadir_rad, in_plane_rad) VALUES (1, 0, 1, 0, 1, 2, 3, 4, x'', 0.9, 'recognised', "
                              "5, 7, 0.5, 1, 0)"));
  }
  const auto sightings = OpenOrDie(path_)->Sightings({});
  ASSERT_EQ(sightings->size(), 1U);
  EXPECT_EQ(sightings->front().view->azimuth_rad, 0.5);
  EXPECT_FALSE(sightings->front().sigma_view_rad);
  EXPECT_FALSE(sightings->front().distance_m);
  EXPECT_FALSE(sightings->front().track);
}

// An index of schema 4: version 5 only renames tables and columns. All of its content is read back.
TEST_F(SqliteStoreTest, MigratesIndexOfVersion4) {
  {
    const auto connection = Connection::Open(path_, Access::kCreate);
    ASSERT_TRUE(Migrate(**connection, Migrations().first(4)));
    const Status filled =
        (*connection)
            ->Execute(
                "INSERT INTO options (id, json) VALUES (1, '{\"f\":1}'), (2, '{\"s\":2}');"
                "INSERT INTO videos (content_id, name, width_px, height_px, frame_count, duration_s, features_options, "
                "start_utc_us) VALUES ('c', 'a.mp4', 640, 480, 100, 3.96, 1, 1700000000000000);"
                "INSERT INTO models (name, model_id, kind) VALUES ('m', 'x1', 'cad'), ('vehicle', 'x2', 'category');"
                "INSERT INTO searches (video, model, next_frame, finished, options, program_version) VALUES "
                "(1, 1, 70, 0, 2, '0.1.0');"
                "INSERT INTO objects (id, model, place_time_s, latitude_rad, longitude_rad, altitude_m, "
                "covariance_enu_m2, "
                "ce90_m, le90_m, heading_rad, rejected) VALUES (1, 1, 2.5, 0.5, 0.25, 80, zeroblob(72), 2, 3, 1.25, "
                "NULL), "
                "(2, 2, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL, 'too large');"
                "INSERT INTO runs (id, object, video, model, score, frames, first_time_s, last_time_s) VALUES "
                "(1, 1, 1, 1, 0.9, 1, 0, 0), (2, 2, 1, 2, 0.8, 1, 1, 2), (3, 1, 1, 1, 0.7, 1, 3, 3);"
                "INSERT INTO sightings (video, frame, run, time_s, box_x_px, box_y_px, box_width_px, box_height_px, "
                "outline, "
                "score, source, matches, view_index, azimuth_rad, off_nadir_rad, in_plane_rad, camera_latitude_rad, "
                "camera_longitude_rad, camera_altitude_m, camera_sigma_m, camera_sigma_rad, line_azimuth_rad, "
                "line_elevation_rad, line_sigma_rad, range_m, range_sigma_m, heading_rad, view_sigma_rad, distance_m, "
                "distance_sigma_m, track) VALUES (1, 7, 3, 0.28, 1, 2, 3, 4, zeroblob(32), 0.9, 'tracked', 5, 6, 0.5, "
                "1, "
                "0.125, 0.5, 0.25, 120, 0.75, 0.01, -1, -0.5, 0.001, 99, 2, 3, 0.03, 98, 1.5, 60000003);"
                "INSERT INTO frame_features (video, frame, time_s, image_width_px, image_height_px, keypoints, "
                "descriptors) "
                "VALUES (1, 50, 2, 640, 480, x'', x'')");
    ASSERT_TRUE(filled) << filled.error().message;
  }
  EXPECT_EQ(OpenError(path_, StoreMode::kRead).code, ErrorCode::kUnsupported) << "reading changes nothing";
  const auto store = OpenOrDie(path_);
  const VideoRecord video = store->Videos()->front();
  EXPECT_EQ(video.features_json, "{\"f\":1}");
  EXPECT_EQ(video.start_utc_us, 1700000000000000);
  const auto models = store->Models();
  ASSERT_EQ(models->size(), 2U);
  EXPECT_EQ(models->front().content_id, "x1");
  EXPECT_EQ(models->front().kind, ModelKind::kCad);
  EXPECT_TRUE(models->back().IsCategory());
  const auto search = store->FindSearch(1, 1);
  ASSERT_TRUE(search && *search);
  EXPECT_EQ((*search)->next_frame, 70);
  EXPECT_EQ((*search)->options_json, "{\"s\":2}");

  const auto objects = store->Objects({.include_rejected = true});
  ASSERT_EQ(objects->size(), 2U);
  EXPECT_THAT(objects->front().tracklets, ::testing::ElementsAre(1, 3));
  EXPECT_EQ(objects->front().place->point.altitude_m, 80);
  EXPECT_EQ(objects->front().heading_rad, 1.25);
  EXPECT_EQ(objects->back().rejected, "too large");
  const auto sightings = store->Sightings({});
  ASSERT_EQ(sightings->size(), 1U);
  const SightingRecord& sighting = sightings->front();
  EXPECT_EQ(sighting.object, 1);
  EXPECT_EQ(sighting.tracklet, 3);
  EXPECT_EQ(sighting.source, SightingSource::kTracked);
  EXPECT_EQ(sighting.track, 60000003);
  EXPECT_EQ(sighting.in_plane_rad, 0.125);
  EXPECT_EQ(sighting.observation->line.azimuth_rad, -1);
  EXPECT_EQ(sighting.observation->line.elevation_rad, -0.5);
  EXPECT_EQ(sighting.observation->line.sigma_rad, 0.001);
  EXPECT_EQ(sighting.observation->line.sigma_range_m, 2);
  EXPECT_EQ(sighting.observation->sigma_attitude_rad, 0.01);
  EXPECT_EQ(sighting.sigma_distance_m, 1.5);
  int kept_frames = 0;
  ASSERT_TRUE(store->VisitKeptFrames({}, [&](KeptFrame&& kept) { return kept.frame == 50 && ++kept_frames > 0; }));
  EXPECT_EQ(kept_frames, 1);

  ASSERT_TRUE(store->DeleteOtherContent("a.mp4", "", "d")) << "the foreign keys were renamed, too";
  EXPECT_TRUE(store->Tracklets()->empty());
  EXPECT_TRUE(store->Sightings({.include_rejected = true})->empty());
  EXPECT_EQ(IntegrityCheck(path_), "ok");
}

// An index of schema 6: its objects get what lists ask for, and their reviews.
TEST_F(SqliteStoreTest, MigratesIndexOfVersion6) {
  {
    const auto connection = Connection::Open(path_, Access::kCreate);
    ASSERT_TRUE(Migrate(**connection, Migrations().first(6)));
    const Status filled =
        (*connection)
            ->Execute(
                "INSERT INTO videos (id, content_id, name, width_px, height_px) VALUES (1, 'c', 'a.mp4', 640, 480);"
                "INSERT INTO models (id, name, content_id, kind) VALUES (1, 'm', '1', 'cad');"
                "INSERT INTO objects (id, model_id, rejection_reason) VALUES (1, 1, NULL), (2, 1, 'place: far'), "
                "(3, 1, 'it floats');"
                "INSERT INTO tracklets (id, object_id, video_id, model_id, score, frames, first_time_s, last_time_s) "
                "VALUES (1, 1, 1, 1, 0.9, 1, 0, 1), (2, 2, 1, 1, 0.5, 2, 3, 4), (3, 3, 1, 1, 0.8, 2, 3, 4), "
                "(4, 1, 1, 1, 0.7, 4, 7, 9);"
                "INSERT INTO sightings (video_id, frame, tracklet_id, time_s, box_x_px, box_y_px, box_width_px, "
                "box_height_px, outline, score, source, matches, view_index, in_plane_rad) VALUES "
                "(1, 5, 2, 3, 100, 100, 40, 40, x'', 0.5, 'recognised', 5, 0, 0);"
                "INSERT INTO reviews VALUES ('c', 'm', 5, 110, 100, 40, 40, 'accepted', 'old', 10), "
                "('c', 'm', 5, 105, 100, 40, 40, 'rejected', 'new', 20), ('c', 'm', 5, 125, 100, 40, 40, NULL, 'far', "
                "30)");
    ASSERT_TRUE(filled) << filled.error().message;
  }
  const auto store = OpenOrDie(path_);
  const auto reviews = store->Reviews();
  ASSERT_EQ(reviews->size(), 1U);
  EXPECT_EQ(reviews->front().object, 2);
  EXPECT_EQ(reviews->front().review.note, "new") << "the latest of those that overlap by half";
  EXPECT_EQ(reviews->front().review.reviewer, "");
  const auto connection = Connection::Open(path_, Access::kRead);
  EXPECT_EQ(*(*connection)
                 ->QueryText("SELECT group_concat(id || ' ' || score || ' ' || frames || ' ' || last_time_s || ' ' || "
                             "is_listed, ', ') FROM objects"),
            "1 0.9 5 9.0 1, 2 0.5 2 4.0 1, 3 0.8 2 4.0 0");
  EXPECT_EQ(IntegrityCheck(path_), "ok");
}

TEST_F(SqliteStoreTest, UnknownKindOrSourceIsDataLoss) {
  ASSERT_TRUE(CommitBatches(path_, 20));
  const auto execute = [&](const std::string& sql) {
    EXPECT_TRUE((*Connection::Open(path_, Access::kWrite))->Execute(sql));
  };
  execute("UPDATE sightings SET source = 'guessed' WHERE frame = 3");
  EXPECT_EQ(OpenOrDie(path_, StoreMode::kRead)->Sightings({}).error().code, ErrorCode::kDataLoss);
  execute("UPDATE models SET kind = 'song'");
  const auto models = OpenOrDie(path_, StoreMode::kRead)->Models();
  ASSERT_FALSE(models);
  EXPECT_EQ(models.error().code, ErrorCode::kDataLoss);
  EXPECT_THAT(models.error().message, HasSubstr("the index is damaged"));
}

TEST_F(SqliteStoreTest, ConcurrentProcessesMayCreateTheSameIndex) {
  for (int round = 0; round < 10; ++round) {
    const fs::path path = folder_ / std::to_string(round);
    std::vector<std::thread> threads;
    std::array<std::string, 4> faults;
    for (std::string& fault : faults) {
      threads.emplace_back([&] {
        const auto store = OpenSqliteStore(path, StoreMode::kCreate);
        fault = store ? "" : store.error().message;
      });
    }
    for (std::thread& thread : threads) thread.join();
    EXPECT_THAT(faults, ::testing::Each(""));
  }
}

TEST_F(SqliteStoreTest, KilledWriterLeavesCompleteBatches) {
  std::int64_t last = 0;
  for (int round = 0; round < 8; ++round) {
    const pid_t child = ::fork();
    if (child == 0) {
      static_cast<void>(CommitBatches(path_, 1'000'000'000));
      ::_exit(1);  // it should have been killed
    }
    // The first is killed at once, the others somewhere after a commit of their own.
    int status = 0;
    while (round > 0 && StoredSightings(path_) <= last) {
      ASSERT_EQ(::waitpid(child, &status, WNOHANG), 0) << "the writer ended by itself";
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(round));
    ::kill(child, SIGKILL);
    ::waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status));
    if (!fs::exists(path_)) continue;  // killed before it began
    if (auto reader = OpenSqliteStore(path_, StoreMode::kRead); reader) last = CountWholeBatches(**reader);
    const std::int64_t done = CountWholeBatches(*OpenOrDie(path_));
    EXPECT_GE(done, last);
    last = done;
    EXPECT_EQ(IntegrityCheck(path_), "ok");
  }
  EXPECT_GT(last, 0) << "no batch was ever committed";
}

TEST_F(SqliteStoreTest, ConcurrentReadersDuringWrites) {
  const auto writer = OpenOrDie(path_);
  const auto video = *writer->PutVideo({.content_id = "c", .name = "a.mp4"});
  const auto model = *writer->PutModel({.name = "m", .content_id = "1", .kind = ModelKind::kPhotos});
  const auto reader = OpenOrDie(path_, StoreMode::kRead);
  for (std::int64_t frame = 0; frame < 100; frame += kSightingsInBatch) {
    ASSERT_TRUE(writer->Commit(Batch(video.id, model.id, frame)));
    EXPECT_EQ(CountWholeBatches(*reader), frame + kSightingsInBatch);
  }
}

TEST_F(SqliteStoreTest, FullDiskIsReportedAndLeavesCompleteBatches) {
  ASSERT_TRUE(CommitBatches(path_, 20));
  EXPECT_EQ(InChild([&] {
              std::signal(SIGXFSZ, SIG_IGN);
              const rlimit limit{300'000, 300'000};
              ::setrlimit(RLIMIT_FSIZE, &limit);
              return ExpectError(CommitBatches(path_, 1'000'000), ErrorCode::kNoSpace);
            }),
            0);
  EXPECT_GT(CountWholeBatches(*OpenOrDie(path_)), 20);
  EXPECT_EQ(IntegrityCheck(path_), "ok");
  EXPECT_TRUE(CommitBatches(path_, 10'000)) << "it resumes when there is space again";
}

TEST_F(SqliteStoreTest, FullDiskIsReportedForANewIndex) {
  for (const rlim_t bytes : {0, 4096, 20'000}) {
    EXPECT_EQ(InChild([&] {
                std::signal(SIGXFSZ, SIG_IGN);
                const rlimit limit{bytes, bytes};
                ::setrlimit(RLIMIT_FSIZE, &limit);
                return ExpectError(OpenSqliteStore(path_, StoreMode::kCreate), ErrorCode::kNoSpace);
              }),
              0)
        << bytes;
  }
  EXPECT_TRUE(CommitBatches(path_, 20)) << "the file left there is taken as new";
}

TEST_F(SqliteStoreTest, ReadOnlyFolderIsReadableNotWritable) {
  ASSERT_TRUE(CommitBatches(path_, 40));
  MakeReadOnly(folder_.path());
  EXPECT_EQ(WithoutRights([&] {
              const auto store = OpenSqliteStore(path_, StoreMode::kRead);
              return store && CountWholeBatches(**store) == 40 ? 0 : 1;
            }),
            0);
  for (const char* name : {"a?b %41.db", "new.db"}) {
    EXPECT_EQ(WithoutRights([&] {
                return ExpectError(OpenSqliteStore(folder_ / name, StoreMode::kCreate), ErrorCode::kPermissionDenied);
              }),
              0)
        << name;
  }
}

TEST_F(SqliteStoreTest, IndexOfKilledWriterIsReadableInReadOnlyFolder) {
  EXPECT_EQ(InChild([&]() -> int {
              auto store = OpenSqliteStore(path_, StoreMode::kCreate);
              const auto video = (*store)->PutVideo({.content_id = "c", .name = "a.mp4"});
              const auto model = (*store)->PutModel({.name = "m", .content_id = "1", .kind = ModelKind::kPhotos});
              static_cast<void>((*store)->Commit(Batch(video->id, model->id, 0)));
              ::kill(::getpid(), SIGKILL);
              return 0;
            }),
            -1);
  ASSERT_EQ(FilesIn(folder_.path()).size(), 3u) << "the database, its log and the log's index";
  MakeReadOnly(folder_.path());
  EXPECT_EQ(WithoutRights([&] {
              const auto store = OpenSqliteStore(path_, StoreMode::kRead);
              return store && CountWholeBatches(**store) == kSightingsInBatch ? 0 : 1;
            }),
            0);
}

}  // namespace
}  // namespace victorious::sqlite

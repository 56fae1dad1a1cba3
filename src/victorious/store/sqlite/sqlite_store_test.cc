// Tests specific to SQLite files: application id, schema version, damage, full disk, killed writer, read-only folder.
#include "victorious/store/sqlite/sqlite_store.h"

#include <array>
#include <csignal>
#include <fstream>
#include <thread>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "testing/data.h"
#include "testing/sighting_batch.h"
#include "victorious/base/file.h"
#include "victorious/store/sqlite/migrations.h"

namespace victorious::sqlite {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using testing::kSightingsInBatch;
using testing::SightingBatch;

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

// Commits batches from the index's progress up to frame `end` or the first error.
Status CommitBatches(const fs::path& path, std::int64_t end) {
  VICTORIOUS_ASSIGN_OR_RETURN(const auto store, OpenSqliteStore(path, StoreMode::kCreate));
  VICTORIOUS_ASSIGN_OR_RETURN(const VideoRecord video, store->PutVideo({.content_id = "c", .name = "a.mp4"}));
  VICTORIOUS_ASSIGN_OR_RETURN(const ModelRecord model,
                              store->PutModel({.name = "m", .content_id = "1", .kind = ModelKind::kPhotos}));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto search, store->FindSearch(video.id, model.id));
  for (std::int64_t frame = search ? search->next_frame : 0; frame < end; frame += kSightingsInBatch) {
    VICTORIOUS_RETURN_IF_ERROR(store->Commit(SightingBatch(video.id, model.id, frame)));
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

TEST_F(SqliteStoreTest, EqualObjectsAreNotWritten) {
  ASSERT_TRUE(CommitBatches(path_, 3));
  const auto writer = OpenSqliteStore(path_, StoreMode::kCreate).value();
  std::vector<ObjectRecord> objects = writer->Objects({.include_rejected = true}).value();
  ASSERT_FALSE(objects.empty());
  objects[0].place = Geolocation{.point = {0.5, 0.25, 300}, .covariance_enu_m2 = Eigen::Matrix3d::Identity()};
  objects[0].heading_rad = 1.25;
  objects[0].place_rejected = "";
  ASSERT_TRUE(writer->PutObjects(objects));
  ASSERT_TRUE(writer->PutReview(objects[0].id, {.verdict = Verdict::kAccepted, .note = "", .reviewer = "ann"}));
  const auto other = OpenSqliteStore(path_, StoreMode::kCreate).value();
  const std::int64_t before = other->ChangeNumber().value();
  ASSERT_TRUE(writer->PutObjects(objects));
  EXPECT_EQ(other->ChangeNumber().value(), before);
  objects[0].heading_rad = 1.5;
  ASSERT_TRUE(writer->PutObjects(objects));
  EXPECT_NE(other->ChangeNumber().value(), before);
}

TEST_F(SqliteStoreTest, ForeignTriggersAndViewsAreRefused) {
  for (const char* const foreign :
       {"CREATE TRIGGER spy AFTER INSERT ON videos BEGIN DELETE FROM reviews; END",
        "CREATE VIEW spy AS SELECT * FROM accounts",
        "DROP TRIGGER tracklet_added; CREATE TRIGGER tracklet_added AFTER INSERT ON tracklets BEGIN SELECT 1; END"}) {
    std::filesystem::remove(path_);
    ASSERT_TRUE(OpenSqliteStore(path_, StoreMode::kCreate));
    ASSERT_TRUE((*Connection::Open(path_, Access::kWrite))->Execute(foreign));
    for (const StoreMode mode : {StoreMode::kCreate, StoreMode::kRead}) {
      const auto opened = OpenSqliteStore(path_, mode);
      ASSERT_FALSE(opened) << foreign;
      EXPECT_EQ(opened.error().code, ErrorCode::kDataLoss);
      EXPECT_THAT(opened.error().message, HasSubstr("that no version of this program made"));
    }
  }
}

TEST_F(SqliteStoreTest, RefusesANewerVersion) {
  ASSERT_TRUE(CommitBatches(path_, 20));
  ASSERT_TRUE((*Connection::Open(path_, Access::kWrite))->Execute("PRAGMA user_version = 99"));
  for (const StoreMode mode : {StoreMode::kCreate, StoreMode::kRead}) {
    const Error error = OpenError(path_, mode);
    EXPECT_EQ(error.code, ErrorCode::kUnsupported);
    EXPECT_THAT(error.message,
                HasSubstr(fmt::format("(schema 99; this program reads up to {})", Migrations().back().version)));
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

// A new index has all tables or none, whenever its process is killed.
TEST_F(SqliteStoreTest, MigratesAllOrNothing) {
  std::vector<Migration> migrations(Migrations().begin(), Migrations().end());
  migrations.push_back({static_cast<int>(migrations.size()) + 1, "DROP TABLE none"});
  const auto connection = Connection::Open(path_, Access::kCreate).value();
  EXPECT_FALSE(Migrate(*connection, migrations));
  EXPECT_EQ(*ReadVersion(*connection, migrations.back().version), 0);
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
    ASSERT_TRUE(writer->Commit(SightingBatch(video.id, model.id, frame)));
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
              static_cast<void>((*store)->Commit(SightingBatch(video->id, model->id, 0)));
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

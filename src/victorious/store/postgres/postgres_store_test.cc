// Tests specific to PostgreSQL: URLs, roles, versions, lost connections, concurrent writers, the geometry of places.
#include "victorious/store/postgres/postgres_store.h"

#include <csignal>
#include <thread>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "testing/data.h"
#include "testing/scratch_postgres.h"
#include "testing/sighting_batch.h"
#include "victorious/store/account_store.h"
#include "victorious/store/job_queue.h"
#include "victorious/store/open_store.h"
#include "victorious/store/postgres/migrations.h"
#include "victorious/store/threshold_store.h"
#include "victorious/store/triage_store.h"

namespace victorious::postgres {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::kSightingsInBatch;
using ::testing::Not;
using testing::SightingBatch;
using ::testing::SizeIs;

class PostgresStoreTest : public ::testing::Test {
 protected:
  void SetUp() override { VICTORIOUS_STORE_OR_SKIP(url_, testing::EmptyPostgresDatabase()); }

  // The URL of another database of the server, by another role.
  [[nodiscard]] std::string UrlOf(const std::string& user, const std::string& database) const {
    return "postgresql://" + user + "@/" + database + url_.substr(url_.find('?'));
  }

  std::unique_ptr<IndexStore> OpenOrDie(StoreMode mode = StoreMode::kCreate) const {
    auto store = OpenPostgresStore(url_, mode);
    if (!store) ADD_FAILURE() << store.error().message;
    return store ? *std::move(store) : nullptr;
  }

  std::unique_ptr<Connection> ConnectOrDie() const {
    auto connection = Connection::Open(url_, false);
    if (!connection) ADD_FAILURE() << connection.error().message;
    return connection ? *std::move(connection) : nullptr;
  }

  void Run(const std::string& sql) const {
    const Status status = ConnectOrDie()->Execute(sql);
    EXPECT_TRUE(status) << status.error().message;
  }

  // Ends all other connections, as a restart of the server does.
  void EndConnections() const {
    Run("SELECT pg_terminate_backend(pid, 10000) FROM pg_stat_activity WHERE datname = current_database() AND "
        "pid <> pg_backend_pid()");
  }

  std::string url_;
};

Error PostgresOpenError(const std::string& url, StoreMode mode = StoreMode::kCreate) {
  const auto store = OpenStore(url, mode);
  EXPECT_FALSE(store) << "opened";
  const Error error = store ? Error{} : store.error();
  EXPECT_EQ(error.message.find('\n'), std::string::npos) << error.message;
  return error;
}

TEST(PostgresName, HasNoPassword) {
  EXPECT_EQ(StoreName("postgresql://me:secret@host:5433/videos?sslmode=require&password=too"),
            "postgresql://me@host:5433/videos");
  EXPECT_EQ(StoreName("postgres://host/videos"), "postgresql://host/videos");
  EXPECT_EQ(StoreName("postgresql:///videos?host=/run/postgresql"), "postgresql:///videos?host=/run/postgresql");
  EXPECT_EQ(StoreName("folder/index.db"), "folder/index.db");
  EXPECT_TRUE(IsDatabaseUrl("postgres://host/videos"));
  EXPECT_FALSE(IsDatabaseUrl("postgresql.db"));
}

TEST(PostgresName, PasswordIsTakenOutOfAUrl) {
  const auto taken = [](const std::string& url) {
    const StoreAddress address = victorious::TakePassword(url);
    return std::pair(address.name, address.password);
  };
  EXPECT_EQ(taken("postgresql://me:s%20t@host:5433/videos?sslmode=require"),
            std::pair(std::string("postgresql://me@host:5433/videos?sslmode=require"), std::string("s t")));
  EXPECT_EQ(taken("postgres://host/videos?password=a&sslmode=require&password=b"),
            std::pair(std::string("postgres://host/videos?sslmode=require"), std::string("b")));
  EXPECT_EQ(taken("postgresql://host/videos?password=a"),
            std::pair(std::string("postgresql://host/videos"), std::string("a")));
  for (const std::string none : {"postgresql://me@host:5433/videos", "postgresql:///videos?host=/run/a:b@c",
                                 "folder/a:b@c.db", "postgresql://host:port/x%"}) {
    EXPECT_EQ(taken(none), std::pair(none, std::string()));
  }
}

TEST(PostgresName, AbsentServerIsUnavailable) {
  const Error error = PostgresOpenError("postgresql://me:secret@127.0.0.1:1/videos");
  EXPECT_EQ(error.code, ErrorCode::kUnavailable);
  EXPECT_THAT(error.message, HasSubstr("postgresql://me@127.0.0.1:1/videos: connection to server"));
  EXPECT_THAT(error.message, HasSubstr("start the server"));
  EXPECT_THAT(error.message, Not(HasSubstr("secret")));
  EXPECT_EQ(PostgresOpenError("postgresql://host:port/x%").code, ErrorCode::kInvalidArgument);
  const auto of_task = Connection::Open("postgresql://me@127.0.0.1:1/videos", false, {}, TaskAttempt{});
  EXPECT_EQ(of_task.error().code, ErrorCode::kUnavailable) << "it was there when the task was claimed";
}

TEST_F(PostgresStoreTest, WrongPasswordAndUnknownDatabase) {
  Run("DO $$ BEGIN CREATE ROLE with_password LOGIN PASSWORD 'right'; EXCEPTION WHEN duplicate_object THEN END $$");
  const Error refused = PostgresOpenError(UrlOf("with_password:wrong", "index"));
  EXPECT_EQ(refused.code, ErrorCode::kPermissionDenied);
  EXPECT_THAT(refused.message, HasSubstr("correct the role and its password"));
  EXPECT_THAT(refused.message, Not(HasSubstr("wrong\n")));
  EXPECT_TRUE(Connection::Open(UrlOf("with_password:right", "index"), false));
  const Error absent = PostgresOpenError(UrlOf("victorious", "none"));
  EXPECT_EQ(absent.code, ErrorCode::kNotFound);
  EXPECT_THAT(absent.message, HasSubstr("\"none\" does not exist"));
  EXPECT_THAT(absent.message, HasSubstr("create it"));
}

TEST_F(PostgresStoreTest, TooManyConnectionsAreNoFaultOfThePassword) {
  Run("DO $$ BEGIN CREATE ROLE one_at_a_time LOGIN CONNECTION LIMIT 1; EXCEPTION WHEN duplicate_object THEN END $$");
  const auto first = Connection::Open(UrlOf("one_at_a_time", "index"), true);
  ASSERT_TRUE(first) << first.error().message;
  const Error error = PostgresOpenError(UrlOf("one_at_a_time", "index"));
  EXPECT_EQ(error.code, ErrorCode::kUnavailable);
  EXPECT_THAT(error.message, HasSubstr("raise the server's max_connections"));
}

// Where the translations are installed, the server speaks German; else the test is one of English.
TEST(PostgresLanguage, ErrorsOfConnectionsAreKnownInAnyLanguage) {
  ::setenv("LANGUAGE", "de", 1);
  const testing::ScratchPostgres server;
  ::unsetenv("LANGUAGE");
  std::string url;
  VICTORIOUS_STORE_OR_SKIP(url, server.url());
  const auto connection = Connection::Open(url, false);
  ASSERT_TRUE(connection) << connection.error().message;
  ASSERT_TRUE((*connection)
                  ->Execute("CREATE ROLE with_password LOGIN PASSWORD 'right';"
                            "CREATE ROLE one_at_a_time LOGIN CONNECTION LIMIT 1"));
  const auto code_of = [&](const std::string& user, const std::string& database) {
    const auto opened = Connection::Open("postgresql://" + user + "@/" + database + url.substr(url.find('?')), true);
    return opened ? ErrorCode::kInternal : opened.error().code;
  };
  EXPECT_EQ(code_of("victorious", "none"), ErrorCode::kNotFound);
  EXPECT_EQ(code_of("with_password:wrong", "index"), ErrorCode::kPermissionDenied);
  EXPECT_EQ(code_of("with_password", "index"), ErrorCode::kPermissionDenied);
  EXPECT_EQ(code_of("nobody", "index"), ErrorCode::kPermissionDenied);
  const auto first = Connection::Open("postgresql://one_at_a_time@/index" + url.substr(url.find('?')), true);
  ASSERT_TRUE(first) << first.error().message;
  EXPECT_EQ(code_of("one_at_a_time", "index"), ErrorCode::kUnavailable);
}

TEST_F(PostgresStoreTest, ReadingMakesNoIndex) {
  const Error error = PostgresOpenError(url_, StoreMode::kRead);
  EXPECT_EQ(error.code, ErrorCode::kNotFound);
  EXPECT_THAT(error.message, HasSubstr("no index in this database"));
  EXPECT_EQ(*ReadVersion(*ConnectOrDie(), 1), 0);
}

TEST_F(PostgresStoreTest, RefusesASchemaOfAnotherProgram) {
  Run("CREATE SCHEMA victorious; CREATE TABLE victorious.notes (note text)");
  for (const StoreMode mode : {StoreMode::kCreate, StoreMode::kRead}) {
    const Error error = PostgresOpenError(url_, mode);
    EXPECT_EQ(error.code, ErrorCode::kUnsupported);
    EXPECT_THAT(error.message, HasSubstr("another program"));
  }
}

TEST_F(PostgresStoreTest, RefusesANewerVersion) {
  OpenOrDie();
  Run("UPDATE version SET schema = 99");
  for (const StoreMode mode : {StoreMode::kCreate, StoreMode::kRead}) {
    const Error error = PostgresOpenError(url_, mode);
    EXPECT_EQ(error.code, ErrorCode::kUnsupported);
    EXPECT_THAT(error.message,
                HasSubstr(fmt::format("(schema 99; this program reads up to {})", Migrations().back().version)));
  }
  Run("DELETE FROM version");
  EXPECT_EQ(PostgresOpenError(url_).code, ErrorCode::kDataLoss);
}

// Another process that updates the objects, and does not come to its end.
TEST_F(PostgresStoreTest, ObjectsHeldByAnotherProcessAreAnErrorThatNamesIt) {
  ASSERT_TRUE(OpenOrDie());
  const auto holder = Connection::Open(url_, false).value();
  ASSERT_TRUE(holder->Query("SELECT pg_advisory_lock(?)", kObjectsLockKey));
  Result row = holder->Query("SELECT pg_backend_pid()::bigint, current_user::text").value();
  ASSERT_TRUE(row.Next());
  int made = 0;
  const auto make = [&]() -> Expected<ObjectUpdate> {
    ++made;
    return ObjectUpdate();
  };
  CancelToken cancel;
  PostgresStore impatient(Connection::Open(url_, false).value(), {.others = {}, .cancelled = std::chrono::hours(1)});
  const Status late = impatient.UpdateObjects(make, cancel);
  ASSERT_FALSE(late);
  EXPECT_EQ(late.error().code, ErrorCode::kUnavailable) << "a worker gives its task back";
  EXPECT_THAT(late.error().message,
              HasSubstr(fmt::format("server process {} of the role {}", row.Integer(0), row.Text(1))));
  cancel.Cancel();
  PostgresStore patient(Connection::Open(url_, false).value(), {.others = std::chrono::hours(1), .cancelled = {}});
  const Status cancelled = patient.UpdateObjects(make, cancel);
  ASSERT_FALSE(cancelled);
  EXPECT_EQ(cancelled.error().code, ErrorCode::kCancelled);
  EXPECT_EQ(made, 0);
  ASSERT_TRUE(holder->Query("SELECT pg_advisory_unlock(?)", kObjectsLockKey));
  EXPECT_TRUE(patient.UpdateObjects(make, cancel)) << "cancelled, it is done if nobody holds it up";
  EXPECT_EQ(made, 1);
}

// An index of schema 1: it has no tasks. Reading does not migrate it.
TEST_F(PostgresStoreTest, MigratesIndexOfVersion1) {
  ASSERT_TRUE(Migrate(*ConnectOrDie(), Migrations().first(1)));
  Run("INSERT INTO videos (content_id, name, folder, width_px, height_px) VALUES ('c', 'a.mp4', '', 640, 480)");
  const Error error = PostgresOpenError(url_, StoreMode::kRead);
  EXPECT_EQ(error.code, ErrorCode::kUnsupported);
  EXPECT_THAT(error.message, HasSubstr(fmt::format("(schema 1; this program reads {})", Migrations().back().version)));
  EXPECT_THAT(*OpenOrDie()->Videos(), SizeIs(1));
  EXPECT_THAT(*OpenOrDie(StoreMode::kRead)->Videos(), SizeIs(1));
}

TEST_F(PostgresStoreTest, StatesOfTasksGetTheirNewNames) {
  ASSERT_TRUE(Migrate(*ConnectOrDie(), Migrations().first(4)));
  Run("INSERT INTO tasks (kind, key, priority, payload, state) VALUES ('index', 'a', 2, '{}', 'waiting'), "
      "('index', 'b', 2, '{}', 'quarantined'), ('index', 'c', 2, '{}', 'done'); "
      "INSERT INTO task_log (task_id, attempt, event, worker) VALUES (1, 1, 'claimed', 'w'), (1, 1, 'returned', 'w')");
  ASSERT_TRUE(OpenOrDie());
  const auto connection = ConnectOrDie();
  const auto column = [&](const char* sql) {
    std::vector<std::string> texts;
    Result rows = connection->Query(sql).value();
    while (rows.Next()) texts.push_back(rows.Text(0));
    return texts;
  };
  EXPECT_THAT(column("SELECT key || ' ' || state FROM tasks ORDER BY id"),
              ElementsAre("a queued", "b failed", "c done"));
  EXPECT_THAT(column("SELECT event FROM task_log ORDER BY id"), ElementsAre("claimed", "released"));
}

TEST_F(PostgresStoreTest, MigrationsAreAppliedOnceAndWhole) {
  OpenOrDie();
  std::vector<Migration> migrations(Migrations().begin(), Migrations().end());
  const int next = static_cast<int>(migrations.size()) + 1;
  migrations.push_back({next, "ALTER TABLE videos ADD COLUMN city text; DROP TABLE none"});
  const auto connection = ConnectOrDie();
  EXPECT_FALSE(Migrate(*connection, migrations));
  EXPECT_EQ(*ReadVersion(*connection, next), next - 1);
  migrations.back().sql = "ALTER TABLE videos ADD COLUMN city text";
  for (int i = 0; i < 2; ++i) {
    const Status status = Migrate(*connection, migrations);
    ASSERT_TRUE(status) << status.error().message;
    EXPECT_EQ(*ReadVersion(*connection, next), next);
  }
}

// Only an administrator may add PostGIS to a database that does not have it.
TEST_F(PostgresStoreTest, SaysThatPostgisIsMissing) {
  Run("DROP DATABASE IF EXISTS plain");
  Run("DO $$ BEGIN CREATE ROLE owner LOGIN; EXCEPTION WHEN duplicate_object THEN END $$");
  Run("CREATE DATABASE plain OWNER owner");
  const Error error = PostgresOpenError(UrlOf("owner", "plain"));
  EXPECT_EQ(error.code, ErrorCode::kPermissionDenied);
  EXPECT_THAT(error.message, HasSubstr("let an administrator run CREATE EXTENSION postgis"));
  const auto store = OpenPostgresStore(UrlOf("victorious", "plain"), StoreMode::kCreate);
  EXPECT_TRUE(store) << store.error().message;
}

// The lists and reviews of an index of schema 9 are made by the migration.
TEST_F(PostgresStoreTest, MigratesObjectsAndReviewsOfVersion9) {
  ASSERT_TRUE(Migrate(*ConnectOrDie(), Migrations().first(9)));
  Run("INSERT INTO videos (content_id, name, folder, width_px, height_px) VALUES ('c', 'a.mp4', '', 640, 480); "
      "INSERT INTO models (name, content_id, kind) VALUES ('jeep', '1', 'cad'); "
      "INSERT INTO objects (id, model_id, object_score) VALUES (1, 1, 0.75), (3, 1, NULL), (4, 1, NULL); "
      "INSERT INTO tracklets (id, object_id, video_id, model_id, score, frames, first_time_s, last_time_s) VALUES "
      "(1, 1, 1, 1, 0.5, 2, 1, 2), (2, 1, 1, 1, 0.9, 3, 4, 5), (3, 3, 1, 1, 0.25, 1, 7, 7); "
      "INSERT INTO sightings (video_id, frame, tracklet_id, time_s, box_x_px, box_y_px, box_width_px, box_height_px, "
      "outline, score, source, matches, view_index, in_plane_rad) VALUES (1, 7, 1, 0.7, 0, 0, 10, 10, '', 0.5, "
      "'recognised', 9, 0, 0); "
      "INSERT INTO reviews (video_content_id, model_name, frame, box_x_px, box_y_px, box_width_px, box_height_px, "
      "verdict, note, updated_utc_us, reviewer) VALUES ('c', 'jeep', 7, 0, 0, 10, 9, 'accepted', 'n', 5, 'ann'), "
      "('c', 'jeep', 7, 0, 0, 10, 10, 'rejected', '', 6, 'bob'), ('c', 'jeep', 7, 90, 0, 10, 10, 'rejected', '', 7, "
      "'')");
  ASSERT_TRUE(OpenOrDie());
  const auto listed = OpenTriageStore(url_).value()->Objects({}, {}).value();
  ASSERT_THAT(listed, SizeIs(2)) << "object 4 has no tracklet";
  const TriageObject& first = listed.front();
  EXPECT_EQ(std::tuple(first.object.id, first.object.score, first.object.frames, first.object.last_time_s),
            std::tuple(1, 0.75, 5, 5.0));
  EXPECT_EQ(first.review.verdict, Verdict::kRejected);
  EXPECT_TRUE(first.is_disputed);
  EXPECT_THAT(first.decisions, SizeIs(2));
  EXPECT_EQ(listed.back().object.score, 0.25);
}

// Two videos that are indexed at once show one object: its summary counts the tracklets of both.
TEST_F(PostgresStoreTest, BatchesOfTwoVideosAddToTheSameObjects) {
  constexpr int kObjects = 3;
  constexpr int kBatches = 20;
  const auto store = OpenOrDie();
  const ModelRecord model = *store->PutModel({.name = "m", .content_id = "1"});
  std::array<VideoRecord, 2> videos;
  std::array<std::vector<std::int64_t>, 2> tracklets;
  for (std::size_t i = 0; i < videos.size(); ++i) {
    videos[i] = *store->PutVideo({.content_id = std::to_string(i), .name = "a.mp4"});
    IndexBatch batch;
    for (int j = 0; j < kObjects; ++j) {
      batch.tracklets.push_back({std::nullopt, {.video = videos[i].id, .model = model.id, .score = 0.5, .frames = 1}});
    }
    tracklets[i] = *store->Commit(batch);
  }
  std::vector<ObjectRecord> joined;
  for (std::size_t j = 0; j < kObjects; ++j) {
    joined.push_back({.id = tracklets[0][j], .model = model.id, .tracklets = {tracklets[0][j], tracklets[1][j]}});
  }
  ASSERT_TRUE(store->PutObjects(joined));
  const auto write = [&](std::size_t i) -> Status {
    VICTORIOUS_ASSIGN_OR_RETURN(const auto own, OpenPostgresStore(url_, StoreMode::kCreate));
    for (int frames = 2; frames < 2 + kBatches; ++frames) {
      IndexBatch batch;
      // The one in ascending, the other in descending order.
      for (std::size_t j = 0; j < kObjects; ++j) {
        batch.tracklets.push_back({tracklets[i][i == 0 ? j : kObjects - 1 - j],
                                   {.video = videos[i].id, .model = model.id, .score = 0.5, .frames = frames}});
      }
      VICTORIOUS_RETURN_IF_ERROR(own->Commit(batch));
    }
    return {};
  };
  std::array<std::string, 2> faults;
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < faults.size(); ++i) {
    threads.emplace_back([&, i] {
      const Status status = write(i);
      faults[i] = status ? "" : status.error().message;
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_THAT(faults, Each(""));
  const auto listed = OpenTriageStore(url_).value()->Objects({}, {}).value();
  ASSERT_THAT(listed, SizeIs(kObjects));
  for (const TriageObject& one : listed) EXPECT_EQ(one.object.frames, 2 * (kBatches + 1));
}

// The rights that docs/cluster.md gives a role that only reads.
TEST_F(PostgresStoreTest, ARoleThatMaySelectReads) {
  OpenOrDie();
  Run("DO $$ BEGIN CREATE ROLE reader LOGIN; EXCEPTION WHEN duplicate_object THEN END $$");
  const std::string url = UrlOf("reader", "index");
  EXPECT_EQ(PostgresOpenError(url, StoreMode::kRead).code, ErrorCode::kPermissionDenied);
  Run("GRANT USAGE ON SCHEMA victorious TO reader; GRANT SELECT ON ALL TABLES IN SCHEMA victorious TO reader; "
      "REVOKE ALL ON victorious.accounts, victorious.credentials, victorious.jobs, victorious.audit FROM reader");
  EXPECT_FALSE(MayServe(url).value());
  EXPECT_TRUE(OpenTriageStore(url).value()->Objects({}, {}));
  EXPECT_EQ(OpenAccountStore(url, StoreMode::kRead).value()->Accounts().error().code, ErrorCode::kPermissionDenied);
  const auto reader = OpenPostgresStore(url, StoreMode::kRead);
  ASSERT_TRUE(reader) << reader.error().message;
  EXPECT_THAT(*(*reader)->Sightings({}), SizeIs(0));
  EXPECT_TRUE((*reader)->Objects({.near = GeoCircle{{0.5, 0.5, 0}, 100}}));
  EXPECT_TRUE((*reader)->Objects({.thresholds = ThresholdUse::kApplied}));
  const auto writer = OpenPostgresStore(url, StoreMode::kCreate);
  ASSERT_TRUE(writer) << writer.error().message;
  EXPECT_EQ((*writer)->PutVideo({.content_id = "c", .name = "a.mp4"}).error().code, ErrorCode::kPermissionDenied);
}

// The rights that docs/cluster.md gives a server without jobs.
TEST_F(PostgresStoreTest, ARoleThatServesWritesReviewsAndNoSightings) {
  const auto store = OpenOrDie();
  const auto video = *store->PutVideo({.content_id = "c", .name = "a.mp4"});
  const auto model = *store->PutModel({.name = "m", .content_id = "1"});
  const std::int64_t object = store->Commit(SightingBatch(video.id, model.id, 0))->front();
  Run("DO $$ BEGIN CREATE ROLE server LOGIN; EXCEPTION WHEN duplicate_object THEN END $$");
  Run("GRANT USAGE ON SCHEMA victorious TO server; GRANT SELECT ON ALL TABLES IN SCHEMA victorious TO server; "
      "GRANT INSERT, UPDATE, DELETE ON victorious.reviews, victorious.decisions, victorious.thresholds, "
      "victorious.jobs, victorious.accounts, victorious.credentials TO server; "
      "GRANT INSERT ON victorious.audit TO server; "
      "GRANT UPDATE (verdict, note, reviewer, reviewed_utc_us, is_contested) ON victorious.objects TO server");
  const std::string url = UrlOf("server", "index");
  EXPECT_TRUE(MayServe(url).value());
  const auto served = OpenPostgresStore(url, StoreMode::kCreate).value();
  const Status reviewed = served->PutReview(object, {Verdict::kAccepted, "", 1, "ann"});
  EXPECT_TRUE(reviewed) << reviewed.error().message;
  EXPECT_EQ(served->Commit(SightingBatch(video.id, model.id, kSightingsInBatch)).error().code,
            ErrorCode::kPermissionDenied);
  EXPECT_TRUE(OpenAccountStore(url, StoreMode::kCreate).value()->Add("ann", Role::kAdmin, "h", 1));
  EXPECT_TRUE(OpenJobQueue(url).value()->Submit({.kind = JobKind::kIndex, .input_json = "{}", .now_us = 1}));
  EXPECT_TRUE(OpenThresholdStore(url, StoreMode::kCreate).value()->Put({.model = "m", .min_score = 0.5}));
}

TEST_F(PostgresStoreTest, RefusesOtherEncodings) {
  Run("DROP DATABASE IF EXISTS latin");
  Run("CREATE DATABASE latin ENCODING LATIN1 LOCALE 'C' TEMPLATE template0");
  const Error error = PostgresOpenError(UrlOf("victorious", "latin"));
  EXPECT_EQ(error.code, ErrorCode::kUnsupported);
  EXPECT_THAT(error.message, HasSubstr("LATIN1"));
}

TEST_F(PostgresStoreTest, IndexWithoutTablesIsDataLoss) {
  const auto store = OpenOrDie();
  Run("DROP TABLE sightings CASCADE");
  EXPECT_EQ(store->Sightings({}).error().code, ErrorCode::kDataLoss);
  Run("INSERT INTO models (name, content_id, kind) VALUES ('m', '1', 'song')");
  EXPECT_EQ(store->Models().error().code, ErrorCode::kDataLoss);
}

TEST_F(PostgresStoreTest, ConcurrentProcessesMayCreateTheSameIndex) {
  std::vector<std::thread> threads;
  std::array<std::string, 4> faults;
  for (std::string& fault : faults) {
    threads.emplace_back([&] {
      const auto store = OpenPostgresStore(url_, StoreMode::kCreate);
      fault = store ? "" : store.error().message;
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_THAT(faults, Each(""));
}

// Writers of different videos and one that joins objects: nothing is lost, none waits for ever.
TEST_F(PostgresStoreTest, WritersOfDifferentVideosDoNotDisturbEachOther) {
  OpenOrDie();
  constexpr int kWriters = 3;
  constexpr int kBatches = 10;
  std::vector<std::thread> threads;
  std::array<std::string, kWriters + 1> faults;
  const auto write = [&](int writer) -> Status {
    VICTORIOUS_ASSIGN_OR_RETURN(const auto store, OpenPostgresStore(url_, StoreMode::kCreate));
    VICTORIOUS_ASSIGN_OR_RETURN(const VideoRecord video,
                                store->PutVideo({.content_id = std::to_string(writer), .name = "a.mp4"}));
    VICTORIOUS_ASSIGN_OR_RETURN(const ModelRecord model, store->PutModel({.name = "m", .content_id = "1"}));
    for (int i = 0; i < kBatches; ++i) {
      VICTORIOUS_RETURN_IF_ERROR(store->Commit(SightingBatch(video.id, model.id, i * kSightingsInBatch)));
    }
    return {};
  };
  const auto join = [&]() -> Status {
    VICTORIOUS_ASSIGN_OR_RETURN(const auto store, OpenPostgresStore(url_, StoreMode::kCreate));
    for (int i = 0; i < kBatches; ++i) {
      VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<TrackletRecord> tracklets, store->Tracklets());
      if (tracklets.empty()) continue;
      ObjectRecord all{.id = tracklets.front().id, .model = tracklets.front().model};
      for (const TrackletRecord& tracklet : tracklets) all.tracklets.push_back(tracklet.id);
      VICTORIOUS_RETURN_IF_ERROR(store->PutObjects(std::span(&all, 1)));
    }
    return {};
  };
  for (int i = 0; i <= kWriters; ++i) {
    threads.emplace_back([&, i] {
      const Status status = i < kWriters ? write(i) : join();
      faults.at(static_cast<std::size_t>(i)) = status ? "" : status.error().message;
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_THAT(faults, Each(""));
  const auto store = OpenOrDie(StoreMode::kRead);
  EXPECT_THAT(*store->Tracklets(), SizeIs(kWriters * kBatches));
  EXPECT_THAT(*store->Sightings({}), SizeIs(kWriters * kBatches * kSightingsInBatch));
}

TEST_F(PostgresStoreTest, KilledWriterLeavesCompleteBatches) {
  const auto store = OpenOrDie();
  const auto video = *store->PutVideo({.content_id = "c", .name = "a.mp4"});
  const auto model = *store->PutModel({.name = "m", .content_id = "1"});
  std::int64_t last = 0;
  for (int round = 0; round < 4; ++round) {
    const pid_t child = ::fork();
    if (child == 0) {
      // A connection of its own: that of the parent must not be used, nor closed.
      const auto writer = OpenPostgresStore(url_, StoreMode::kCreate);
      for (std::int64_t frame = last; writer && (*writer)->Commit(SightingBatch(video.id, model.id, frame));) {
        frame += kSightingsInBatch;
      }
      ::_exit(1);  // it should have been killed
    }
    int status = 0;
    std::int64_t done = last;
    while (done <= last) {
      ASSERT_EQ(::waitpid(child, &status, WNOHANG), 0) << "the writer ended by itself";
      const auto search = store->FindSearch(video.id, model.id);
      ASSERT_TRUE(search) << search.error().message;
      if (*search) done = (*search)->next_frame;
    }
    ::kill(child, SIGKILL);
    ::waitpid(child, &status, 0);
    // Ends what the server may still do for the killed process.
    EndConnections();
    const auto search = store->FindSearch(video.id, model.id);
    ASSERT_TRUE(search) << search.error().message;
    last = (*search)->next_frame;
    EXPECT_EQ(std::ssize(*store->Sightings({})), last);
    EXPECT_EQ(std::ssize(*store->Objects({})), last / kSightingsInBatch);
  }
}

TEST_F(PostgresStoreTest, ReconnectsBetweenTransactions) {
  const auto store = OpenOrDie();
  const auto video = *store->PutVideo({.content_id = "c", .name = "a.mp4"});
  const auto model = *store->PutModel({.name = "m", .content_id = "1"});
  EndConnections();
  EXPECT_THAT(*store->Videos(), SizeIs(1)) << "a query";
  EndConnections();
  const auto committed = store->Commit(SightingBatch(video.id, model.id, 0));
  EXPECT_TRUE(committed) << "a transaction: " << committed.error().message;
  EndConnections();
  EXPECT_THAT(*store->Sightings({}), SizeIs(kSightingsInBatch)) << "a visit";
}

TEST_F(PostgresStoreTest, LostConnectionEndsATransactionWithAnError) {
  OpenOrDie();
  const auto connection = ConnectOrDie();
  {
    auto transaction = Transaction::Begin(*connection, Exclusion::kShared);
    ASSERT_TRUE(transaction);
    ASSERT_TRUE(connection->Execute("INSERT INTO options (json) VALUES ('first')"));
    EndConnections();
    const Status second = connection->Execute("INSERT INTO options (json) VALUES ('second')");
    ASSERT_FALSE(second) << "without the first";
    EXPECT_THAT(second.error().message, HasSubstr("the connection was lost"));
    EXPECT_FALSE(transaction->Commit());
  }
  auto count = connection->Query("SELECT count(*) FROM options");
  ASSERT_TRUE(count) << count.error().message;
  ASSERT_TRUE(count->Next());
  EXPECT_EQ(count->Integer(0), 0);
}

TEST_F(PostgresStoreTest, LostConnectionEndsAVisitWithAnError) {
  const auto store = OpenOrDie();
  const auto video = *store->PutVideo({.content_id = "c", .name = "a.mp4"});
  const auto model = *store->PutModel({.name = "m", .content_id = "1"});
  IndexBatch batch = SightingBatch(video.id, model.id, 0);
  for (std::int64_t frame = kSightingsInBatch; frame < 5000; ++frame) {
    batch.sightings.push_back(batch.sightings.front());
    batch.sightings.back().sighting.frame = frame;
  }
  ASSERT_TRUE(store->Commit(batch));
  int seen = 0;
  const Status status = store->VisitSightings({}, [&](SightingRecord&&) {
    if (seen++ == 0) EndConnections();
    return true;
  });
  EXPECT_FALSE(status) << "a part would be taken for the whole";
  EXPECT_LT(seen, 5000);
  EXPECT_THAT(*store->Sightings({}), SizeIs(5000));
}

// What a file that is damaged, or an administrator who turned triggers off, leaves.
TEST_F(PostgresStoreTest, FindsFaults) {
  const auto store = OpenOrDie();
  const std::int64_t video = store->PutVideo({.content_id = "c", .name = "a.mp4", .width = 64, .height = 48})->id;
  const std::int64_t model = store->PutModel({.name = "shed", .content_id = "m", .kind = ModelKind::kPhotos})->id;
  const auto ids = store->Commit(SightingBatch(video, model, 0));
  ASSERT_TRUE(ids) << ids.error().message;
  EXPECT_THAT(store->FindFaults().value(), SizeIs(0));
  Run("UPDATE sightings SET source = 'guess' WHERE frame = 3");
  EXPECT_THAT(store->FindFaults().value(), ElementsAre(HasSubstr("unknown source")));
  Run("SET session_replication_role = replica; DELETE FROM models");
  EXPECT_THAT(
      store->FindFaults().value(),
      ElementsAre("rows of searches without their row of models: 1", "rows of objects without their row of models: 1",
                  "rows of tracklets without their row of models: 1", HasSubstr("unknown source")));
  EndConnections();
  Run("ALTER TABLE models RENAME TO lost");
  EXPECT_FALSE(store->FindFaults().value().empty()) << "a missing table";
}

TEST_F(PostgresStoreTest, PlacesAreGeometries) {
  const auto store = OpenOrDie();
  const auto video = *store->PutVideo({.content_id = "c", .name = "a.mp4"});
  const auto model = *store->PutModel({.name = "m", .content_id = "1"});
  const auto ids = store->Commit(SightingBatch(video.id, model.id, 0));
  ASSERT_TRUE(ids);
  Geolocation place{.point = {0.5, -0.25, 80}};
  place.covariance_enu_m2.setIdentity();
  const ObjectRecord object{.id = ids->front(), .model = model.id, .tracklets = *ids, .place = place};
  ASSERT_TRUE(store->PutObjects(std::span(&object, 1)));
  auto row = ConnectOrDie()->Query(
      "SELECT radians(ST_Y(place)), radians(ST_X(place)), ST_Z(place), ST_SRID(place)::bigint, "
      "(SELECT count(*) FROM pg_indexes WHERE tablename = 'objects' AND indexdef LIKE '%gist (place)%') FROM objects");
  ASSERT_TRUE(row) << row.error().message;
  ASSERT_TRUE(row->Next());
  EXPECT_NEAR(row->Real(0), 0.5, 1e-12);
  EXPECT_NEAR(row->Real(1), -0.25, 1e-12);
  EXPECT_EQ(row->Real(2), 80);
  EXPECT_EQ(row->Integer(3), 4979);
  EXPECT_EQ(row->Integer(4), 1);
}

}  // namespace
}  // namespace victorious::postgres

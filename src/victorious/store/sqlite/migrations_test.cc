// Older indexes are brought to the present schema with their content.
#include "victorious/store/sqlite/migrations.h"

#include <filesystem>
#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/data.h"
#include "victorious/store/sqlite/sqlite_store.h"

namespace victorious::sqlite {
namespace {

std::unique_ptr<IndexStore> OpenMigrated(const std::filesystem::path& path) {
  auto store = OpenSqliteStore(path, StoreMode::kCreate);
  if (!store) ADD_FAILURE() << store.error().message;
  return store ? *std::move(store) : nullptr;
}

std::string CheckMigrated(const std::filesystem::path& path) {
  return Connection::Open(path, Access::kWrite).value()->QueryText("PRAGMA integrity_check").value();
}

class MigrationTest : public ::testing::Test {
 protected:
  testing::ScratchFolder folder_;
  std::filesystem::path path_ = folder_ / "index.db";
};

// An index of schema 7 does not know the folders of its videos.
TEST_F(MigrationTest, MigratesIndexOfVersion7) {
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

// An index of schema 1, written by program 0.1.0: its objects become tracklets and objects with the same ids.
TEST_F(MigrationTest, MigratesIndexOfVersion1) {
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
  EXPECT_EQ(OpenSqliteStore(path_, StoreMode::kRead).error().code, ErrorCode::kUnsupported)
      << "reading changes nothing";
  const auto store = OpenMigrated(path_);
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
  IndexBatch batch;
  batch.tracklets.push_back({std::nullopt, {.video = 1, .model = 1, .score = 0.5, .frames = 1}});
  batch.sightings.push_back({0, {.frame = 20, .outline = {{0, 0}, {9, 0}, {9, 9}}, .score = 0.5}});
  const auto ids = store->Commit(batch);
  ASSERT_TRUE(ids) << ids.error().message;
  EXPECT_EQ(ids->front(), 10) << "ids are unique";
  EXPECT_EQ(CheckMigrated(path_), "ok");
}

// An index of schema 2: its sightings have the matched views; the distances of the objects are unknown.
TEST_F(MigrationTest, MigratesIndexOfVersion2) {
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
  const auto sightings = OpenMigrated(path_)->Sightings({});
  ASSERT_EQ(sightings->size(), 1U);
  EXPECT_EQ(sightings->front().view->azimuth_rad, 0.5);
  EXPECT_FALSE(sightings->front().sigma_view_rad);
  EXPECT_FALSE(sightings->front().distance_m);
  EXPECT_FALSE(sightings->front().track);
}

// An index of schema 4: version 5 only renames tables and columns. All of its content is read back.
TEST_F(MigrationTest, MigratesIndexOfVersion4) {
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
  EXPECT_EQ(OpenSqliteStore(path_, StoreMode::kRead).error().code, ErrorCode::kUnsupported)
      << "reading changes nothing";
  const auto store = OpenMigrated(path_);
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
  EXPECT_EQ(CheckMigrated(path_), "ok");
}

// An index of schema 6: its objects get what lists ask for, and their reviews.
TEST_F(MigrationTest, MigratesIndexOfVersion6) {
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
  const auto store = OpenMigrated(path_);
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
  EXPECT_EQ(CheckMigrated(path_), "ok");
}

// An index of schema 11: one review for a place, of whoever decided last. Each becomes the decision of its person.
TEST_F(MigrationTest, MigratesReviewsOfVersion11) {
  {
    const auto connection = Connection::Open(path_, Access::kCreate);
    ASSERT_TRUE(Migrate(**connection, Migrations().first(11)));
    const Status filled =
        (*connection)
            ->Execute(
                "INSERT INTO videos (id, content_id, name, width_px, height_px) VALUES (1, 'c', 'a.mp4', 640, 480);"
                "INSERT INTO models (id, name, content_id, kind) VALUES (1, 'm', '1', 'cad');"
                "INSERT INTO objects (id, model_id) VALUES (1, 1);"
                "INSERT INTO tracklets (id, object_id, video_id, model_id, score, frames, first_time_s, last_time_s) "
                "VALUES (1, 1, 1, 1, 0.9, 1, 0, 1), (2, 1, 1, 1, 0.5, 2, 3, 4);"
                "INSERT INTO sightings (video_id, frame, tracklet_id, time_s, box_x_px, box_y_px, box_width_px, "
                "box_height_px, outline, score, source, matches, view_index, in_plane_rad) VALUES "
                "(1, 5, 1, 3, 100, 100, 40, 40, x'', 0.5, 'recognised', 5, 0, 0), "
                "(1, 9, 2, 4, 100, 100, 40, 40, x'', 0.5, 'recognised', 5, 0, 0);"
                "INSERT INTO reviews VALUES ('c', 'm', 5, 100, 100, 40, 40, 'accepted', 'yes', 10, 'ann'), "
                "('c', 'm', 9, 100, 100, 40, 40, 'rejected', 'no', 20, 'bob');"
                "UPDATE objects SET verdict = 'rejected', note = 'no', reviewer = 'bob', reviewed_utc_us = 20");
    ASSERT_TRUE(filled) << filled.error().message;
  }
  const auto store = OpenMigrated(path_);
  const auto decisions = store->Decisions(1);
  ASSERT_TRUE(decisions) << decisions.error().message;
  ASSERT_EQ(decisions->size(), 2U);
  EXPECT_EQ(decisions->front().reviewer, "bob");
  EXPECT_EQ(decisions->back().note, "yes");
  EXPECT_EQ(store->Reviews()->front().review.reviewer, "bob");
  const auto connection = Connection::Open(path_, Access::kRead);
  EXPECT_EQ(*(*connection)->QueryText("SELECT is_contested FROM objects"), "1");
  EXPECT_EQ(CheckMigrated(path_), "ok");
}

// An index of schema 20: of its searches as much is known as their options and the lengths of the videos tell.
TEST_F(MigrationTest, MigratesSearchesOfVersion20) {
  {
    const auto connection = Connection::Open(path_, Access::kCreate);
    ASSERT_TRUE(Migrate(**connection, Migrations().first(20)));
    const Status filled =
        (*connection)
            ->Execute(
                "INSERT INTO options (id, json) VALUES (1, '{\"every\":3}'), (2, "
                "'{\"searched\":{\"from_s\":1.5,\"to_s\":4}}'), (3, 'none');"
                "INSERT INTO videos (id, content_id, name, width_px, height_px, frame_count, duration_s) VALUES "
                "(1, 'a', 'a.mp4', 640, 480, 101, 10), (2, 'b', 'b.mp4', 640, 480, NULL, NULL);"
                "INSERT INTO models (id, name, content_id, kind) VALUES (1, 'm', '1', 'cad'), (2, 'n', '2', 'cad'), "
                "(3, 'o', '3', 'cad');"
                "INSERT INTO searches (video_id, model_id, next_frame, finished, options_id, program_version) VALUES "
                "(1, 1, 101, 1, 1, ''), (1, 2, 41, 1, 2, ''), (1, 3, 51, 0, 3, ''), (2, 1, 30, 0, 1, ''), "
                "(2, 2, 0, 0, 1, '');"
                "INSERT INTO kept_frames (video_id, frame, time_s, image_width_px, image_height_px, keypoints, "
                "descriptors) VALUES (2, 20, 2, 640, 480, x'', x''), (2, 40, 4, 640, 480, x'', x'')");
    ASSERT_TRUE(filled) << filled.error().message;
  }
  const auto store = OpenMigrated(path_);
  const auto part = [](std::int64_t video, std::int64_t model, std::int64_t to_frame, double from_s, double to_s) {
    return SearchPart{video, model, SearchPartKind::kSearched, 0, to_frame, from_s, to_s};
  };
  EXPECT_THAT(*store->SearchParts(1),
              ::testing::ElementsAre(part(1, 1, 101, 0, 10), part(1, 2, 41, 1.5, 4), part(1, 3, 51, 0, 5)));
  EXPECT_THAT(*store->SearchParts(2), ::testing::ElementsAre(part(2, 1, 30, 0, 2)));
  EXPECT_EQ(CheckMigrated(path_), "ok");
}

}  // namespace
}  // namespace victorious::sqlite

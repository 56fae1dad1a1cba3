// The contract of IndexStore, tested for every implementation.
#include "victorious/store/index_store.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/data.h"
#include "testing/scratch_postgres.h"
#include "victorious/store/open_store.h"

namespace victorious {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

class IndexStoreTest : public ::testing::TestWithParam<testing::StoreKind> {
 protected:
  void SetUp() override {
    VICTORIOUS_STORE_OR_SKIP(name_, GetParam().make(folder_.path()));
    Reopen();
    video_ = PutVideo("c1", "/data/flight/a.mp4").id;
    model_ = PutModel("humvee", "m1").id;
  }

  void Reopen() {
    store_.reset();
    auto store = OpenStore(name_, StoreMode::kCreate);
    ASSERT_TRUE(store) << store.error().message;
    store_ = *std::move(store);
  }

  VideoRecord PutVideo(const std::string& content_id, const std::string& name) {
    const auto video = store_->PutVideo({.content_id = content_id, .name = name, .width = 640, .height = 480});
    EXPECT_TRUE(video) << video.error().message;
    return video.value_or(VideoRecord{});
  }

  ModelRecord PutModel(const std::string& name, const std::string& id) {
    const auto model = store_->PutModel({.name = name, .content_id = id, .kind = ModelKind::kPhotos});
    EXPECT_TRUE(model) << model.error().message;
    return model.value_or(ModelRecord{});
  }

  // One object with sightings in `frames` frames of 0.5 s from `first_frame` on.
  IndexBatch MakeBatch(std::int64_t first_frame, int frames, double score) const {
    IndexBatch batch;
    batch.tracklets.push_back({std::nullopt,
                               {.video = video_,
                                .model = model_,
                                .score = score,
                                .frames = frames,
                                .first_time_s = 0.5 * static_cast<double>(first_frame),
                                .last_time_s = 0.5 * static_cast<double>(first_frame + frames - 1)}});
    for (int i = 0; i < frames; ++i) {
      const std::int64_t frame = first_frame + i;
      batch.sightings.push_back({0,
                                 {.frame = frame,
                                  .time_s = 0.5 * static_cast<double>(frame),
                                  .box = {1.25, 2.5, 30, 40},
                                  .outline = {{1, 2}, {31, 2.125}, {31, 42}},
                                  .score = score,
                                  .matches = 14,
                                  .view_index = 3,
                                  .in_plane_rad = 0.25,
                                  .sigma_view_rad = 0.03,
                                  .distance_m = 120.5,
                                  .sigma_distance_m = 1.5,
                                  .track = 60000003}});
    }
    return batch;
  }

  IndexBatch::Progress ProgressTo(std::int64_t next_frame, std::int64_t expected) const {
    return {{.video = video_,
             .model = model_,
             .next_frame = next_frame,
             .options_json = R"({"ratio":0.8})",
             .program_version = "1.2.3"},
            expected};
  }

  std::int64_t CommitOne(const IndexBatch& batch) {
    const auto ids = store_->Commit(batch);
    EXPECT_TRUE(ids) << ids.error().message;
    return ids && ids->size() == 1 ? ids->front() : -1;
  }

  std::vector<SightingRecord> Sightings(const SightingFilter& filter = {}) {
    auto sightings = store_->Sightings(filter);
    EXPECT_TRUE(sightings) << sightings.error().message;
    return sightings.value_or(std::vector<SightingRecord>{});
  }

  std::vector<std::int64_t> ObjectIds(const SightingFilter& filter = {}) {
    const auto objects = store_->Objects(filter);
    EXPECT_TRUE(objects) << objects.error().message;
    std::vector<std::int64_t> ids;
    for (const ObjectRecord& object : *objects) ids.push_back(object.id);
    return ids;
  }

  std::vector<std::int64_t> KeptFrames(const SightingFilter& filter = {}) {
    std::vector<std::int64_t> frames;
    EXPECT_TRUE(store_->VisitKeptFrames(filter, [&](KeptFrame&& kept) {
      frames.push_back(kept.frame);
      return true;
    }));
    return frames;
  }

  testing::ScratchFolder folder_;
  std::string name_;
  std::unique_ptr<IndexStore> store_;
  std::int64_t video_ = 0;
  std::int64_t model_ = 0;
};

TEST_P(IndexStoreTest, VideoIsIdentifiedByContentAndNamedAsLastGiven) {
  const VideoRecord again = PutVideo("c1", "moved/a.mp4");
  EXPECT_EQ(again.id, video_);
  EXPECT_EQ(again.name, "moved/a.mp4");
  EXPECT_EQ(again.width, 640);
  EXPECT_FALSE(again.frame_count);
  EXPECT_NE(PutVideo("c2", "moved/a.mp4").id, video_);
  EXPECT_THAT(*store_->Videos(), SizeIs(2));
}

TEST_P(IndexStoreTest, VideoLengthAndFeaturesRoundTrip) {
  ASSERT_TRUE(store_->SetVideoLength(video_, 100, 49.5));
  ASSERT_TRUE(store_->SetVideoFeatures(video_, R"({"engine":"opencv"})"));
  Reopen();
  const VideoRecord video = PutVideo("c1", "a.mp4");
  EXPECT_EQ(video.frame_count, 100);
  EXPECT_EQ(video.duration_s, 49.5);
  EXPECT_EQ(video.features_json, R"({"engine":"opencv"})");
  ASSERT_TRUE(store_->SetVideoFeatures(video_, ""));
  EXPECT_EQ(PutVideo("c1", "a.mp4").features_json, "");
  EXPECT_EQ(store_->SetVideoLength(99, 1, 1).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(store_->SetVideoFeatures(99, "{}").error().code, ErrorCode::kNotFound);
}

TEST_P(IndexStoreTest, SightingRoundTrips) {
  IndexBatch batch = MakeBatch(7, 1, 0.75);
  batch.sightings[0].sighting.view = ViewDirection{1.5, 0.5};
  batch.sightings[0].sighting.source = SightingSource::kTracked;
  batch.sightings[0].sighting.is_missed = true;
  const std::int64_t object = CommitOne(batch);
  Reopen();
  const auto sightings = Sightings();
  ASSERT_THAT(sightings, SizeIs(1));
  const SightingRecord& s = sightings[0];
  EXPECT_EQ(s.object, object);
  EXPECT_EQ(s.video, video_);
  EXPECT_EQ(s.model, model_);
  EXPECT_EQ(s.frame, 7);
  EXPECT_EQ(s.time_s, 3.5);
  EXPECT_EQ(s.box, (Box{1.25, 2.5, 30, 40}));
  EXPECT_EQ(s.outline, batch.sightings[0].sighting.outline);
  EXPECT_EQ(s.score, 0.75);
  EXPECT_EQ(std::pair(s.source, s.is_missed), std::pair(SightingSource::kTracked, true));
  EXPECT_EQ(s.matches, 14);
  EXPECT_EQ(s.view_index, 3);
  ASSERT_TRUE(s.view);
  EXPECT_EQ(s.view->azimuth_rad, 1.5);
  EXPECT_EQ(s.view->off_nadir_rad, 0.5);
  EXPECT_EQ(s.in_plane_rad, 0.25);
  EXPECT_EQ(s.sigma_view_rad, 0.03);
  EXPECT_EQ(s.distance_m, 120.5);
  EXPECT_EQ(s.sigma_distance_m, 1.5);
  EXPECT_EQ(s.track, 60000003);
}

TEST_P(IndexStoreTest, UnknownAnglesAndOutlineRoundTrip) {
  IndexBatch batch = MakeBatch(0, 1, 0.5);
  batch.sightings[0].sighting.outline.clear();
  CommitOne(batch);
  ASSERT_THAT(Sightings(), SizeIs(1));
  EXPECT_FALSE(Sightings()[0].view);
  EXPECT_TRUE(Sightings()[0].outline.empty());
}

TEST_P(IndexStoreTest, CommitExtendsATracklet) {
  const std::int64_t id = CommitOne(MakeBatch(0, 2, 0.5));
  IndexBatch more = MakeBatch(2, 1, 0.9);
  more.tracklets[0].id = id;
  more.tracklets[0].tracklet.frames = 3;
  more.tracklets[0].tracklet.first_time_s = 0;
  EXPECT_EQ(CommitOne(more), id);
  const auto objects = store_->Objects({});
  ASSERT_THAT(*objects, SizeIs(1));
  EXPECT_EQ(objects->front().frames, 3);
  EXPECT_EQ(objects->front().score, 0.9);
  EXPECT_EQ(objects->front().last_time_s, 1.0);
  EXPECT_THAT(Sightings(), SizeIs(3));
}

Geolocation SomePlace(double latitude_rad) {
  Geolocation place{.point = {latitude_rad, 0.25, 80}, .time_s = 1.5, .ce90_m = 2, .le90_m = 3};
  place.covariance_enu_m2 = Eigen::Vector3d(1, 2, 3).asDiagonal();
  place.covariance_enu_m2(0, 1) = place.covariance_enu_m2(1, 0) = 0.5;
  return place;
}

TEST_P(IndexStoreTest, BearingObservationRoundTrips) {
  IndexBatch batch = MakeBatch(7, 2, 0.75);
  batch.sightings[0].sighting.observation =
      BearingObservation{.line = {.time_s = 3.5,
                                  .camera = {0.5, 0.25, 120},
                                  .azimuth_rad = -1,
                                  .elevation_rad = -0.75,
                                  .range_m = 99,
                                  .sigma_rad = 0.001,
                                  .sigma_range_m = 2,
                                  .clock_shift = ClockShift{{3, -4, 0.5}, 0.01, -0.02},
                                  .focal_shift = FocalShift{0.05, 0.003, -0.004}},
                         .heading_rad = 3,
                         .sigma_position_m = 0.5,
                         .sigma_attitude_rad = 0.01};
  CommitOne(batch);
  const auto sightings = Sightings();
  ASSERT_THAT(sightings, SizeIs(2));
  EXPECT_FALSE(sightings[1].observation);
  ASSERT_TRUE(sightings[0].observation);
  const BearingObservation& observation = *sightings[0].observation;
  EXPECT_EQ(observation.line.time_s, 3.5);
  EXPECT_EQ(observation.line.camera, (GeodeticPoint{0.5, 0.25, 120}));
  EXPECT_EQ(observation.line.azimuth_rad, -1);
  EXPECT_EQ(observation.line.elevation_rad, -0.75);
  EXPECT_EQ(observation.line.range_m, 99);
  EXPECT_EQ(observation.line.sigma_rad, 0.001);
  EXPECT_EQ(observation.line.sigma_range_m, 2);
  EXPECT_EQ(observation.heading_rad, 3);
  EXPECT_EQ(observation.sigma_position_m, 0.5);
  EXPECT_EQ(observation.sigma_attitude_rad, 0.01);
  ASSERT_TRUE(observation.line.clock_shift);
  EXPECT_EQ(observation.line.clock_shift->camera_enu_m, Eigen::Vector3d(3, -4, 0.5));
  EXPECT_EQ(observation.line.clock_shift->azimuth_rad, 0.01);
  EXPECT_EQ(observation.line.clock_shift->elevation_rad, -0.02);
  ASSERT_TRUE(observation.line.focal_shift);
  EXPECT_EQ(observation.line.focal_shift->sigma, 0.05);
  EXPECT_EQ(observation.line.focal_shift->azimuth_rad, 0.003);
  EXPECT_EQ(observation.line.focal_shift->elevation_rad, -0.004);
}

TEST_P(IndexStoreTest, SightingsAreThoseOfATrackletInItsVideo) {
  const std::int64_t first = CommitOne(MakeBatch(0, 2, 0.5));
  CommitOne(MakeBatch(0, 3, 0.9));
  EXPECT_THAT(Sightings({.tracklet = first}), SizeIs(2));
  EXPECT_THAT(Sightings({.video = video_, .tracklet = first}), SizeIs(2));
  EXPECT_THAT(Sightings({.video = video_ + 1, .tracklet = first}), SizeIs(0));
}

TEST_P(IndexStoreTest, TrackletsAreMergedToOneObjectWithAPlace) {
  const std::int64_t first = CommitOne(MakeBatch(0, 2, 0.5));
  const std::int64_t second = CommitOne(MakeBatch(10, 3, 0.9));
  ObjectRecord object{.id = first, .model = model_, .tracklets = {first, second}, .place = SomePlace(0.5)};
  object.place->velocity_enu = Eigen::Vector3d(1, -2, 0);
  object.place->velocity_covariance_enu = Eigen::Matrix3d::Identity();
  object.heading_rad = 1.25;
  ASSERT_TRUE(store_->PutObjects(std::span(&object, 1)));
  Reopen();
  const auto objects = store_->Objects({});
  ASSERT_THAT(*objects, SizeIs(1));
  const ObjectRecord& stored = objects->front();
  EXPECT_EQ(stored.id, first);
  EXPECT_EQ(stored.frames, 5);
  EXPECT_EQ(stored.score, 0.9);
  EXPECT_EQ(stored.first_time_s, 0);
  EXPECT_EQ(stored.last_time_s, 6);
  EXPECT_THAT(stored.videos, ElementsAre(video_));
  EXPECT_THAT(stored.tracklets, ElementsAre(first, second));
  ASSERT_TRUE(stored.place);
  EXPECT_EQ(stored.place->point, object.place->point);
  EXPECT_EQ(stored.place->time_s, 1.5);
  EXPECT_EQ(stored.place->covariance_enu_m2, object.place->covariance_enu_m2);
  EXPECT_EQ(stored.place->velocity_enu, object.place->velocity_enu);
  EXPECT_EQ(stored.place->ce90_m, 2);
  EXPECT_EQ(stored.place->le90_m, 3);
  EXPECT_EQ(stored.heading_rad, 1.25);
  for (const SightingRecord& sighting : Sightings()) EXPECT_EQ(sighting.object, first);

  // After the split, the second object has its own id again, and unknown values are empty.
  const std::vector<ObjectRecord> apart = {{.id = first, .model = model_, .tracklets = {first}},
                                           {.id = second, .model = model_, .tracklets = {second}}};
  ASSERT_TRUE(store_->PutObjects(apart));
  EXPECT_THAT(ObjectIds(), ElementsAre(second, first));
  EXPECT_FALSE(store_->Objects({})->front().place);
  EXPECT_FALSE(store_->Objects({})->back().heading_rad);
}

TEST_P(IndexStoreTest, ObjectOfTwoVideosSurvivesRemovalOfOne) {
  const std::int64_t first = CommitOne(MakeBatch(0, 2, 0.5));
  const std::int64_t one = video_;
  video_ = PutVideo("c2", "b.mp4").id;
  const std::int64_t second = CommitOne(MakeBatch(0, 2, 0.6));
  const ObjectRecord object{.id = first, .model = model_, .tracklets = {first, second}};
  ASSERT_TRUE(store_->PutObjects(std::span(&object, 1)));
  EXPECT_THAT(store_->Objects({.video_name = "b.mp4"})->front().videos, ElementsAre(one, video_));
  ASSERT_TRUE(store_->DeleteSearch(one, model_));
  const auto objects = store_->Objects({});
  ASSERT_THAT(*objects, SizeIs(1));
  EXPECT_THAT(objects->front().videos, ElementsAre(video_));
  EXPECT_EQ(objects->front().frames, 2);
}

TEST_P(IndexStoreTest, RejectedObjectsAreExcludedByDefault) {
  const std::int64_t id = CommitOne(MakeBatch(0, 2, 0.5));
  const ObjectRecord object{.id = id, .model = model_, .tracklets = {id}, .rejected = "7 times too large"};
  ASSERT_TRUE(store_->PutObjects(std::span(&object, 1)));
  EXPECT_THAT(ObjectIds(), ElementsAre());
  EXPECT_THAT(Sightings(), SizeIs(0));
  EXPECT_THAT(Sightings({.include_rejected = true}), SizeIs(2));
  EXPECT_EQ(store_->Objects({.include_rejected = true})->front().rejected, "7 times too large");
}

TEST_P(IndexStoreTest, AnObjectWhosePlaceIsRejectedIsListed) {
  const std::int64_t id = CommitOne(MakeBatch(0, 2, 0.5));
  const ObjectRecord object{.id = id, .model = model_, .tracklets = {id}, .place_rejected = "7 times too large"};
  ASSERT_TRUE(store_->PutObjects(std::span(&object, 1)));
  ASSERT_THAT(ObjectIds(), ElementsAre(id));
  EXPECT_THAT(Sightings(), SizeIs(2));
  EXPECT_EQ(store_->Objects({})->front().place_rejected, "7 times too large");
  EXPECT_EQ(store_->Objects({})->front().rejected, "");
}

TEST_P(IndexStoreTest, NearFilterUsesGroundDistance) {
  const std::int64_t here = CommitOne(MakeBatch(0, 1, 0.5));
  const std::int64_t there = CommitOne(MakeBatch(5, 1, 0.6));
  CommitOne(MakeBatch(8, 1, 0.7));  // of unknown place
  constexpr double kEarthRadiusM = 6.37e6;
  const std::vector<ObjectRecord> objects = {
      {.id = here, .model = model_, .tracklets = {here}, .place = SomePlace(0.5)},
      {.id = there, .model = model_, .tracklets = {there}, .place = SomePlace(0.5 + 100 / kEarthRadiusM)}};
  ASSERT_TRUE(store_->PutObjects(objects));
  const auto within = [](double radius_m) { return SightingFilter{.near = GeoCircle{{0.5, 0.25, -3000}, radius_m}}; };
  EXPECT_THAT(ObjectIds(within(90)), ElementsAre(here));
  EXPECT_THAT(ObjectIds(within(110)), ElementsAre(there, here));
  EXPECT_THAT(Sightings(within(90)), SizeIs(1));
  SightingFilter late = within(110);
  late.from_s = 2;
  EXPECT_THAT(ObjectIds(late), ElementsAre(there));
}

TEST_P(IndexStoreTest, FilterSelectsOneObjectAndOneVideo) {
  const std::int64_t here = CommitOne(MakeBatch(0, 3, 0.5));
  video_ = PutVideo("c2", "/data/b.mp4").id;
  const std::int64_t there = CommitOne(MakeBatch(0, 2, 0.5));
  EXPECT_THAT(ObjectIds({.object = there}), ElementsAre(there));
  EXPECT_THAT(Sightings({.object = here}), SizeIs(3));
  EXPECT_THAT(ObjectIds({.video = video_}), ElementsAre(there));
  EXPECT_THAT(Sightings({.video = video_}), SizeIs(2));
  EXPECT_THAT(Sightings({.object = here, .video = video_}), SizeIs(0));
}

TEST_P(IndexStoreTest, CommitIsAtomic) {
  IndexBatch batch = MakeBatch(0, 3, 0.5);
  batch.progress.push_back(ProgressTo(3, 0));
  batch.sightings[2].sighting.frame = 1;  // two sightings of one tracklet in one frame
  const auto result = store_->Commit(batch);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::kInvalidArgument);
  EXPECT_TRUE(Sightings().empty());
  EXPECT_TRUE(ObjectIds().empty());
  EXPECT_FALSE(store_->FindSearch(video_, model_)->has_value());
  batch.sightings[2].sighting.frame = 2;
  EXPECT_TRUE(store_->Commit(batch));
}

TEST_P(IndexStoreTest, RefusesUnknownIds) {
  IndexBatch batch = MakeBatch(0, 1, 0.5);
  batch.tracklets[0].id = 1234;
  EXPECT_EQ(store_->Commit(batch).error().code, ErrorCode::kNotFound);
  batch.tracklets[0].id.reset();
  batch.tracklets[0].tracklet.video = 1234;
  EXPECT_EQ(store_->Commit(batch).error().code, ErrorCode::kNotFound);
}

TEST_P(IndexStoreTest, ProgressAdvancesOnlyFromItsStoredFrame) {
  IndexBatch batch;
  batch.progress.push_back(ProgressTo(10, 0));
  ASSERT_TRUE(store_->Commit(batch));
  const auto refused = store_->Commit(batch);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("another process is indexing the same video"));

  batch.progress[0] = ProgressTo(20, 10);
  batch.progress[0].search.finished = true;
  ASSERT_TRUE(store_->Commit(batch));
  Reopen();
  const auto search = store_->FindSearch(video_, model_);
  ASSERT_TRUE(search && *search);
  EXPECT_EQ((*search)->next_frame, 20);
  EXPECT_TRUE((*search)->finished);
  EXPECT_EQ((*search)->options_json, R"({"ratio":0.8})");
  EXPECT_EQ((*search)->program_version, "1.2.3");
  EXPECT_FALSE(store_->FindSearch(video_, model_ + 1)->has_value());
}

TEST_P(IndexStoreTest, DeletingASearchRemovesOnlyItsSightings) {
  const std::int64_t other = PutModel("shed", "m2").id;
  IndexBatch kept = MakeBatch(0, 2, 0.5);
  kept.tracklets[0].tracklet.model = other;
  const std::int64_t kept_id = CommitOne(kept);
  IndexBatch batch = MakeBatch(0, 2, 0.6);
  batch.progress.push_back(ProgressTo(2, 0));
  const std::int64_t forgotten_id = CommitOne(batch);

  ASSERT_TRUE(store_->DeleteSearch(video_, model_));
  EXPECT_THAT(ObjectIds(), ElementsAre(kept_id));
  EXPECT_THAT(Sightings(), SizeIs(2));
  EXPECT_FALSE(store_->FindSearch(video_, model_)->has_value());
  Reopen();
  EXPECT_GT(CommitOne(batch), forgotten_id) << "ids are not reused";
}

TEST_P(IndexStoreTest, ModelOfOtherContentReplacesTheOldOne) {
  IndexBatch batch = MakeBatch(0, 2, 0.6);
  batch.progress.push_back(ProgressTo(2, 0));
  CommitOne(batch);
  EXPECT_EQ(PutModel("humvee", "m1").id, model_) << "the content is the same";
  EXPECT_THAT(Sightings(), SizeIs(2));

  const ModelRecord replaced = PutModel("humvee", "m2");
  EXPECT_NE(replaced.id, model_);
  EXPECT_EQ(replaced.content_id, "m2");
  EXPECT_TRUE(Sightings().empty());
  EXPECT_TRUE(ObjectIds().empty());
  EXPECT_FALSE(store_->FindSearch(video_, model_)->has_value());
  EXPECT_THAT(*store_->Models(), SizeIs(1));
}

TEST_P(IndexStoreTest, ObjectsAreSortedByScore) {
  const std::int64_t a = CommitOne(MakeBatch(0, 1, 0.5));
  const std::int64_t b = CommitOne(MakeBatch(1, 3, 0.5));
  const std::int64_t c = CommitOne(MakeBatch(4, 1, 0.9));
  const std::int64_t d = CommitOne(MakeBatch(5, 1, 0.5));
  EXPECT_THAT(ObjectIds(), ElementsAre(c, b, a, d));
}

TEST_P(IndexStoreTest, SightingsAreSortedByVideoFrameAndObject) {
  const std::int64_t first_video = video_;
  const std::int64_t second_video = PutVideo("c0", "b.mp4").id;
  video_ = second_video;
  CommitOne(MakeBatch(0, 1, 0.5));
  video_ = first_video;
  const std::int64_t a = CommitOne(MakeBatch(5, 2, 0.5));
  const std::int64_t b = CommitOne(MakeBatch(4, 2, 0.5));
  std::vector<std::array<std::int64_t, 3>> order;
  for (const SightingRecord& s : Sightings()) order.push_back({s.video, s.frame, s.object});
  ASSERT_THAT(order, SizeIs(5));
  EXPECT_EQ(order[0], (std::array{first_video, std::int64_t{4}, b}));
  EXPECT_EQ(order[1], (std::array{first_video, std::int64_t{5}, a}));
  EXPECT_EQ(order[2], (std::array{first_video, std::int64_t{5}, b}));
  EXPECT_EQ(order[4][0], second_video);
}

TEST_P(IndexStoreTest, FiltersByModelVideoAndTime) {
  const std::int64_t early = CommitOne(MakeBatch(0, 3, 0.5));  // 0 to 1 s
  const std::int64_t late = CommitOne(MakeBatch(10, 3, 0.4));  // 5 to 6 s
  EXPECT_THAT(ObjectIds({.model_name = "humvee"}), ElementsAre(early, late));
  EXPECT_TRUE(ObjectIds({.model_name = "shed"}).empty());
  EXPECT_THAT(ObjectIds({.video_name = "flight/a.mp4"}), SizeIs(2));
  EXPECT_TRUE(ObjectIds({.video_name = "b.mp4"}).empty());
  EXPECT_THAT(ObjectIds({.from_s = 1.0}), ElementsAre(early, late)) << "bounds are inclusive";
  EXPECT_THAT(ObjectIds({.from_s = 1.1}), ElementsAre(late));
  EXPECT_THAT(ObjectIds({.to_s = 4.9}), ElementsAre(early));
  EXPECT_TRUE(ObjectIds({.from_s = 2.0, .to_s = 4.0}).empty());
  EXPECT_THAT(Sightings({.from_s = 0.5, .to_s = 5.0}), SizeIs(3));
  EXPECT_THAT(Sightings({.model_name = "humvee", .video_name = "a.mp4", .to_s = 1.0}), SizeIs(3));
  EXPECT_TRUE(Sightings({.model_name = "shed"}).empty());
}

TEST_P(IndexStoreTest, FiltersByCategory) {
  const std::int64_t of_model = CommitOne(MakeBatch(0, 1, 0.5));
  const auto of_category = [&](const std::string& name, double score) {
    model_ = store_->PutModel({.name = name, .content_id = "c", .kind = ModelKind::kCategory}).value().id;
    return CommitOne(MakeBatch(0, 1, score));
  };
  const std::int64_t car = of_category("vehicle/car", 0.9);
  const std::int64_t vehicle = of_category("vehicle", 0.8);
  const std::int64_t vehicles = of_category("vehicles", 0.7);
  EXPECT_THAT(ObjectIds({.category_name = "vehicle"}), ElementsAre(car, vehicle));
  EXPECT_THAT(ObjectIds({.category_name = "vehicle/car"}), ElementsAre(car));
  EXPECT_THAT(ObjectIds({.category_name = "vehicles"}), ElementsAre(vehicles));
  EXPECT_TRUE(ObjectIds({.category_name = "humvee"}).empty()) << "a model";
  EXPECT_TRUE(ObjectIds({.model_name = "vehicle"}).empty()) << "a category";
  EXPECT_THAT(ObjectIds({.model_name = "humvee"}), ElementsAre(of_model));
  EXPECT_THAT(Sightings({.category_name = "vehicle"}), SizeIs(2));
}

TEST_P(IndexStoreTest, VisitStopsOnFalse) {
  CommitOne(MakeBatch(0, 5, 0.5));
  int seen = 0;
  EXPECT_TRUE(store_->VisitSightings({}, [&](SightingRecord&&) { return ++seen < 2; }));
  EXPECT_EQ(seen, 2);
  EXPECT_TRUE(store_->SetVideoLength(video_, 5, 2.0)) << "no lock remains";
}

TEST_P(IndexStoreTest, QueriesAreAllowedDuringAVisit) {
  CommitOne(MakeBatch(0, 3, 0.5));
  std::size_t inner = 0;
  EXPECT_TRUE(store_->VisitSightings({}, [&](SightingRecord&&) {
    inner += Sightings().size();
    return true;
  }));
  EXPECT_EQ(inner, 9u);
}

TEST_P(IndexStoreTest, KeptFramesAreVisitedOnceInOrder) {
  IndexBatch batch;
  for (const std::int64_t frame : {30, 0, 60}) {
    KeptFrame kept{.video = video_, .frame = frame, .time_s = static_cast<double>(frame)};
    kept.features.image_width = 640;
    kept.features.image_height = 480;
    kept.features.keypoints = {{1.5f, 2.5f, 3.0f, -0.5f}, {4, 5, 6, 1}};
    kept.features.descriptors.resize(2 * kDescriptorSize, static_cast<std::uint8_t>(frame));
    batch.kept_frames.push_back(kept);
  }
  batch.kept_frames.push_back({.video = video_, .frame = 90, .time_s = 90});  // without features
  ASSERT_TRUE(store_->Commit(batch));
  for (KeptFrame& kept : batch.kept_frames) kept.time_s = -1;
  ASSERT_TRUE(store_->Commit(batch)) << "the existing file is unchanged";

  EXPECT_THAT(KeptFrames(), ElementsAre(0, 30, 60, 90));
  EXPECT_THAT(KeptFrames({.from_s = 1, .to_s = 60}), ElementsAre(30, 60));
  EXPECT_TRUE(KeptFrames({.video_name = "b.mp4"}).empty());
  ASSERT_TRUE(store_->VisitKeptFrames({.from_s = 30}, [&](KeptFrame&& kept) {
    EXPECT_EQ(kept.time_s, 30);
    EXPECT_EQ(kept.features.image_width, 640);
    EXPECT_EQ(kept.features.image_height, 480);
    EXPECT_EQ(kept.features.keypoints, batch.kept_frames[0].features.keypoints);
    const std::vector<std::uint8_t>& stored = batch.kept_frames[0].features.descriptors;
    EXPECT_EQ(kept.features.descriptors.size(), stored.size());
    for (std::size_t i = 0; i < std::min(stored.size(), kept.features.descriptors.size()); ++i) {
      EXPECT_NEAR(kept.features.descriptors[i], stored[i], 17) << "4 bits an element";
    }
    return false;
  }));
  ASSERT_TRUE(store_->DeleteKeptFrames(video_));
  EXPECT_TRUE(KeptFrames().empty());
}

TEST_P(IndexStoreTest, IdsFollowOneAnother) {
  EXPECT_EQ(PutVideo("c2", "b.mp4").id, video_ + 1);
  EXPECT_EQ(PutModel("shed", "m2").id, model_ + 1);
  IndexBatch batch = MakeBatch(0, 1, 0.5);
  for (int i = 1; i < 20; ++i) batch.tracklets.push_back(batch.tracklets[0]);
  const auto ids = store_->Commit(batch);
  ASSERT_TRUE(ids) << ids.error().message;
  for (std::size_t i = 0; i < ids->size(); ++i) EXPECT_EQ((*ids)[i], static_cast<std::int64_t>(i) + 1);
}

TEST_P(IndexStoreTest, OfTwoWritersWithTheSameProgressOneFails) {
  const auto other = OpenStore(name_, StoreMode::kCreate).value();
  IndexBatch batch = MakeBatch(0, 2, 0.5);
  batch.progress.push_back(ProgressTo(10, 0));
  ASSERT_TRUE(store_->Commit(batch));
  EXPECT_EQ(other->Commit(batch).error().code, ErrorCode::kConflict);
  EXPECT_THAT(Sightings(), SizeIs(2)) << "nothing of the second was written";
  batch.progress[0] = ProgressTo(20, 5);
  EXPECT_EQ(other->Commit(batch).error().code, ErrorCode::kConflict);
  ASSERT_TRUE(other->DeleteSearch(video_, model_));
  EXPECT_EQ(other->Commit(batch).error().code, ErrorCode::kConflict) << "deleted meanwhile";
}

TEST_P(IndexStoreTest, AReaderDoesNotWrite) {
  const std::int64_t object = CommitOne(MakeBatch(0, 2, 0.5));
  const auto reader = OpenStore(name_, StoreMode::kRead).value();
  EXPECT_THAT(*reader->Sightings({}), SizeIs(2));
  EXPECT_EQ(reader->PutReview(object, {Verdict::kAccepted, "", 1}).error().code, ErrorCode::kPermissionDenied);
  EXPECT_EQ(reader->DeleteSearch(video_, model_).error().code, ErrorCode::kPermissionDenied);
  EXPECT_THAT(*reader->Sightings({}), SizeIs(2));
}

TEST_P(IndexStoreTest, NearFilterReachesPolesAndTheAntimeridian) {
  const auto place_at = [&](double latitude_rad, double longitude_rad) {
    const std::int64_t id = CommitOne(MakeBatch(0, 1, 0.5));
    Geolocation place = SomePlace(latitude_rad);
    place.point.longitude_rad = longitude_rad;
    return ObjectRecord{.id = id, .model = model_, .tracklets = {id}, .place = place};
  };
  const std::vector<ObjectRecord> objects = {place_at(0.2, 3.14159), place_at(0.2, -3.14159), place_at(1.5707, 1),
                                             place_at(1.5707, -2), place_at(-0.9, 0.5)};
  ASSERT_TRUE(store_->PutObjects(objects));
  const auto near = [&](double latitude_rad, double longitude_rad, double radius_m) {
    return ObjectIds({.near = GeoCircle{{latitude_rad, longitude_rad, 0}, radius_m}});
  };
  EXPECT_THAT(near(0.2, 3.1415, 2000), ElementsAre(objects[0].id, objects[1].id));
  EXPECT_THAT(near(1.57, 0, 10'000), ElementsAre(objects[2].id, objects[3].id));
  EXPECT_THAT(near(-0.9, 0.501, 4000), ElementsAre(objects[4].id));
}

VICTORIOUS_TEST_ON_ALL_STORES(IndexStoreTest);

}  // namespace
}  // namespace victorious

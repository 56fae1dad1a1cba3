// The contract of IndexStore for two tracklets that become one, tested for every implementation.
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/data.h"
#include "testing/scratch_postgres.h"
#include "victorious/store/index_store.h"
#include "victorious/store/open_store.h"

namespace victorious {
namespace {

using ::testing::ElementsAre;
using ::testing::SizeIs;

class JoinedTrackletsTest : public ::testing::TestWithParam<testing::StoreKind> {
 protected:
  void SetUp() override {
    VICTORIOUS_STORE_OR_SKIP(name_, GetParam().make(folder_.path()));
    auto store = OpenStore(name_, StoreMode::kCreate);
    ASSERT_TRUE(store) << store.error().message;
    store_ = *std::move(store);
    video_ = store_->PutVideo({.content_id = "c1", .name = "a.mp4", .width = 640, .height = 480})->id;
    model_ = store_->PutModel({.name = "shed", .content_id = "m1", .kind = ModelKind::kPhotos})->id;
  }

  // A tracklet of two frames a second.
  std::int64_t Commit(int first_frame, int frames, double score) {
    IndexBatch batch;
    batch.tracklets.push_back({.id = {},
                               .tracklet = {.video = video_,
                                            .model = model_,
                                            .score = score,
                                            .frames = frames,
                                            .first_time_s = 0.5 * first_frame,
                                            .last_time_s = 0.5 * (first_frame + frames - 1)}});
    for (int frame = first_frame; frame < first_frame + frames; ++frame) {
      batch.sightings.push_back(
          {0, {.frame = frame, .box = {1, 2, 3, 4}, .outline = {{1, 2}, {4, 2}, {4, 6}}, .score = score}});
    }
    const auto ids = store_->Commit(batch);
    EXPECT_TRUE(ids) << ids.error().message;
    return ids ? ids->front() : -1;
  }

  [[nodiscard]] Expected<std::vector<std::int64_t>> Join(std::int64_t into, std::int64_t from) {
    IndexBatch batch;
    batch.joined.push_back({.into = into, .from = from});
    return store_->Commit(batch);
  }

  [[nodiscard]] std::vector<std::int64_t> ObjectIds() const {
    std::vector<std::int64_t> ids;
    const std::vector<ObjectRecord> objects = store_->Objects({}).value();
    for (const ObjectRecord& object : objects) ids.push_back(object.id);
    return ids;
  }

  testing::ScratchFolder folder_;
  std::string name_;
  std::unique_ptr<IndexStore> store_;
  std::int64_t video_ = 0;
  std::int64_t model_ = 0;
};

TEST_P(JoinedTrackletsTest, HaveTheSightingsOfBoth) {
  const std::int64_t first = Commit(0, 2, 0.5);
  const std::int64_t second = Commit(10, 3, 0.9);
  const std::int64_t other = Commit(30, 1, 0.7);
  ASSERT_TRUE(Join(first, second));
  const auto tracklets = store_->Tracklets().value();
  ASSERT_THAT(tracklets, SizeIs(2));
  EXPECT_EQ(tracklets[0].id, first);
  EXPECT_EQ(tracklets[0].frames, 5);
  EXPECT_EQ(tracklets[0].score, 0.9);
  EXPECT_EQ(tracklets[0].first_time_s, 0);
  EXPECT_EQ(tracklets[0].last_time_s, 6);
  EXPECT_EQ(tracklets[1].id, other);
  EXPECT_THAT(ObjectIds(), ElementsAre(first, other));
  std::vector<std::int64_t> frames;
  const std::vector<SightingRecord> sightings = store_->Sightings({}).value();
  for (const SightingRecord& sighting : sightings) {
    if (sighting.object == first) frames.push_back(sighting.frame);
  }
  EXPECT_THAT(frames, ElementsAre(0, 1, 10, 11, 12));
}

// The object of the second tracklet has another one, which stays with it.
TEST_P(JoinedTrackletsTest, AnObjectWithOtherTrackletsStays) {
  const std::int64_t first = Commit(0, 2, 0.5);
  const std::int64_t second = Commit(10, 3, 0.6);
  const std::int64_t third = Commit(20, 1, 0.7);
  const std::vector<ObjectRecord> objects = {{.id = first, .model = model_, .tracklets = {first}},
                                             {.id = second, .model = model_, .tracklets = {second, third}}};
  ASSERT_TRUE(store_->PutObjects(objects));
  ASSERT_TRUE(Join(first, second));
  EXPECT_THAT(ObjectIds(), ElementsAre(second, first));
  EXPECT_THAT(store_->Sightings({}).value(), SizeIs(6));
}

TEST_P(JoinedTrackletsTest, AreOfOneModel) {
  const std::int64_t first = Commit(0, 2, 0.5);
  model_ = store_->PutModel({.name = "hall", .content_id = "m2", .kind = ModelKind::kPhotos})->id;
  const std::int64_t second = Commit(10, 3, 0.9);
  EXPECT_EQ(Join(first, second).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(Join(first, second + 99).error().code, ErrorCode::kNotFound);
  EXPECT_THAT(store_->Tracklets().value(), SizeIs(2));
  const std::vector<SightingRecord> sightings = store_->Sightings({}).value();
  for (const SightingRecord& sighting : sightings) EXPECT_EQ(sighting.object, sighting.frame < 5 ? first : second);
}

VICTORIOUS_TEST_ON_ALL_STORES(JoinedTrackletsTest);

}  // namespace
}  // namespace victorious

// The contract of IndexStore for what data association reads and keeps, tested for every implementation.
#include <algorithm>
#include <span>
#include <string_view>
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

std::vector<std::byte> Bytes(std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

class KeptFitsTest : public ::testing::TestWithParam<testing::StoreKind> {
 protected:
  void SetUp() override {
    VICTORIOUS_STORE_OR_SKIP(name_, GetParam().make(folder_.path()));
    Reopen();
    video_ = store_->PutVideo({.content_id = "c1", .name = "a.mp4", .width = 640, .height = 480})->id;
    model_ = store_->PutModel({.name = "humvee", .content_id = "m1", .kind = ModelKind::kPhotos})->id;
  }

  void Reopen() {
    store_.reset();
    auto store = OpenStore(name_, StoreMode::kCreate);
    ASSERT_TRUE(store) << store.error().message;
    store_ = *std::move(store);
  }

  // A tracklet with a sighting in each of `frames` frames; more of the tracklet `id`, if it is given.
  std::int64_t Commit(std::int64_t first_frame, int frames, std::optional<std::int64_t> id = {}) {
    IndexBatch batch;
    batch.tracklets.push_back({id, {.video = video_, .model = model_, .score = 0.5, .frames = frames}});
    for (int i = 0; i < frames; ++i) {
      batch.sightings.push_back(
          {0, {.frame = first_frame + i, .box = {1, 2, 3, 4}, .outline = {{1, 2}, {4, 2}, {4, 6}}, .score = 0.5}});
    }
    const auto ids = store_->Commit(batch);
    EXPECT_TRUE(ids) << ids.error().message;
    return ids ? ids->front() : -1;
  }

  std::vector<std::pair<FitKey, std::vector<std::byte>>> KeptFits() {
    std::vector<std::pair<FitKey, std::vector<std::byte>>> fits;
    EXPECT_TRUE(store_->VisitKeptFits([&](KeptFit&& kept) {
      EXPECT_TRUE(kept.path.empty());
      fits.emplace_back(kept.key, std::move(kept.fit));
      return true;
    }));
    std::ranges::sort(fits);
    return fits;
  }

  void Put(const ObjectUpdate& update) {
    ASSERT_TRUE(store_->UpdateObjects([&]() -> Expected<ObjectUpdate> { return update; }, CancelToken()));
  }

  testing::ScratchFolder folder_;
  std::string name_;
  std::unique_ptr<IndexStore> store_;
  std::int64_t video_ = 0;
  std::int64_t model_ = 0;
};

TEST_P(KeptFitsTest, RevisionOfATrackletChangesWithItsSightings) {
  const auto revision = [&] { return store_->Tracklets()->front().revision; };
  const std::int64_t id = Commit(0, 2);
  const std::int64_t first = revision();
  const ObjectRecord object{.id = id, .model = model_, .tracklets = {id}, .heading_rad = 1.0};
  ASSERT_TRUE(store_->PutObjects(std::span(&object, 1)));
  EXPECT_EQ(revision(), first) << "the object is not the tracklet's content";
  Commit(2, 1, id);
  EXPECT_NE(revision(), first);
}

TEST_P(KeptFitsTest, AreStoredReplacedAndDeleted) {
  const std::int64_t a = Commit(0, 2);
  const std::int64_t b = Commit(4, 2);
  const std::vector<ObjectRecord> objects = {{.id = a, .model = model_, .tracklets = {a}},
                                             {.id = b, .model = model_, .tracklets = {b}, .heading_rad = 0.5}};
  const FitKey first{a, -1234567890123456789};
  const FitKey other{a, 7};
  const FitKey last{b, 7};
  Put({.objects = objects,
       .put_fits = {{first, Bytes("one"), Bytes("way")}, {other, Bytes("two"), {}}, {last, Bytes("three"), {}}},
       .deleted_fits = {}});
  EXPECT_EQ(store_->Objects({.object = b})->front().heading_rad, 0.5) << "stored with the objects";
  EXPECT_THAT(KeptFits(), ElementsAre(std::pair(first, Bytes("one")), std::pair(other, Bytes("two")),
                                      std::pair(last, Bytes("three"))));
  EXPECT_EQ(store_->FindKeptPath(first).value(), Bytes("way"));
  EXPECT_TRUE(store_->FindKeptPath(other)->empty());
  EXPECT_TRUE(store_->FindKeptPath({b, 8})->empty());

  Put({.objects = objects, .put_fits = {{first, Bytes("longer"), {}}}, .deleted_fits = {other, {b, 99}}});
  Reopen();
  EXPECT_THAT(KeptFits(), ElementsAre(std::pair(first, Bytes("longer")), std::pair(last, Bytes("three"))));
  EXPECT_EQ(store_->FindKeptPath(first).value(), Bytes("way")) << "a fit without a path leaves it";
}

TEST_P(KeptFitsTest, AreStoredWhileObjectsAreMade) {
  const std::int64_t a = Commit(0, 2);
  const std::vector<KeptFit> fits = {{{a, 1}, Bytes("x"), Bytes("y")}, {{a + 1000, 1}, Bytes("of none"), {}}};
  const auto make = [&]() -> Expected<ObjectUpdate> {
    EXPECT_TRUE(store_->PutFits(fits));
    return Fail(ErrorCode::kCancelled, "stopped");
  };
  EXPECT_EQ(store_->UpdateObjects(make, CancelToken()).error().code, ErrorCode::kCancelled);
  Reopen();
  EXPECT_THAT(KeptFits(), ElementsAre(std::pair(FitKey{a, 1}, Bytes("x"))));
  EXPECT_EQ(store_->FindKeptPath({a, 1}).value(), Bytes("y"));
}

TEST_P(KeptFitsTest, GoWithTheirTracklet) {
  const std::int64_t a = Commit(0, 2);
  Put({.objects = {{.id = a, .model = model_, .tracklets = {a}}},
       .put_fits = {{{a, 1}, Bytes("x"), Bytes("y")}, {{a + 1000, 1}, Bytes("of none"), {}}},
       .deleted_fits = {}});
  EXPECT_THAT(KeptFits(), SizeIs(1)) << "a tracklet that was deleted meanwhile keeps none";
  ASSERT_TRUE(store_->DeleteSearch(video_, model_));
  EXPECT_THAT(KeptFits(), SizeIs(0));
}

TEST_P(KeptFitsTest, ListsAllSearches) {
  EXPECT_THAT(*store_->Searches(), SizeIs(0));
  const SearchRecord search{
      .video = video_, .model = model_, .next_frame = 40, .options_json = "{}", .program_version = "1"};
  ASSERT_TRUE(store_->Commit({.progress = {{search, 0}}}));
  const auto searches = store_->Searches();
  ASSERT_THAT(*searches, SizeIs(1));
  EXPECT_EQ(searches->front().video, video_);
  EXPECT_EQ(searches->front().model, model_);
  EXPECT_EQ(searches->front().next_frame, 40);
  EXPECT_EQ(searches->front().options_json, "{}");
}

TEST_P(KeptFitsTest, TrackletFilterSelectsItsSightings) {
  const std::int64_t a = Commit(0, 2);
  const std::int64_t b = Commit(4, 3);
  const ObjectRecord object{.id = a, .model = model_, .tracklets = {a, b}};
  ASSERT_TRUE(store_->PutObjects(std::span(&object, 1)));
  EXPECT_THAT(*store_->Sightings({.tracklet = a}), SizeIs(2));
  EXPECT_THAT(*store_->Sightings({.tracklet = b}), SizeIs(3));
  EXPECT_THAT(*store_->Objects({.tracklet = b}), SizeIs(1));
  EXPECT_THAT(*store_->Objects({.tracklet = b + 1}), SizeIs(0));
}

TEST_P(KeptFitsTest, AnObjectHasItsOwnScoreAndWhatSpeaksAgainstIt) {
  const std::int64_t id = Commit(0, 2);
  ObjectRecord object{.id = id, .model = model_, .tracklets = {id}};
  ASSERT_TRUE(store_->PutObjects(std::span(&object, 1)));
  EXPECT_EQ(store_->Objects({})->front().score, 0.5) << "without an own score, the best of its tracklets";
  EXPECT_EQ(store_->Objects({})->front().object_score, std::nullopt);
  object.object_score = 0.25;
  object.against = {"size 12 % off", "seen from one side only"};
  object.evidence_json = R"({"strength":1.5})";
  ASSERT_TRUE(store_->PutObjects(std::span(&object, 1)));
  const ObjectRecord stored = store_->Objects({})->front();
  EXPECT_EQ(stored.score, 0.25);
  EXPECT_EQ(stored.object_score, 0.25);
  EXPECT_THAT(stored.against, ElementsAre("size 12 % off", "seen from one side only"));
  EXPECT_EQ(stored.evidence_json, R"({"strength":1.5})");
  object.object_score.reset();
  object.against.clear();
  ASSERT_TRUE(store_->PutObjects(std::span(&object, 1)));
  EXPECT_EQ(store_->Objects({})->front().score, 0.5);
  EXPECT_TRUE(store_->Objects({})->front().against.empty());
}

VICTORIOUS_TEST_ON_ALL_STORES(KeptFitsTest);

}  // namespace
}  // namespace victorious

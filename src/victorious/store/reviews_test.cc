// Reviews in an index, tested for every implementation: bound to places in a video, resolved to the objects that are
// there.
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

class ReviewsTest : public ::testing::TestWithParam<testing::StoreKind> {
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

  // One tracklet with sightings in `frames` frames from `first_frame` on.
  IndexBatch MakeBatch(std::int64_t first_frame, int frames, double score) const {
    IndexBatch batch;
    batch.tracklets.push_back(
        {std::nullopt, {.video = video_, .model = model_, .score = score, .frames = frames, .last_time_s = 9}});
    for (int i = 0; i < frames; ++i) {
      batch.sightings.push_back({0,
                                 {.frame = first_frame + i,
                                  .time_s = 0.5 * static_cast<double>(first_frame + i),
                                  .box = {1.25, 2.5, 30, 40},
                                  .outline = {{1, 2}, {31, 2}, {31, 42}},
                                  .score = score,
                                  .matches = 14}});
    }
    return batch;
  }

  std::int64_t CommitOne(const IndexBatch& batch) {
    const auto ids = store_->Commit(batch);
    EXPECT_TRUE(ids) << ids.error().message;
    return ids ? ids->front() : 0;
  }

  testing::ScratchFolder folder_;
  std::string name_;
  std::unique_ptr<IndexStore> store_;
  std::int64_t video_ = 0;
  std::int64_t model_ = 0;
};

TEST_P(ReviewsTest, ReviewIsReplacedAndDeleted) {
  const std::int64_t object = CommitOne(MakeBatch(0, 3, 0.5));
  CommitOne(MakeBatch(8, 1, 0.5));
  EXPECT_TRUE(store_->Reviews()->empty());
  ASSERT_TRUE(store_->PutReview(object, {Verdict::kAccepted, "by the barn", 10}));
  Reopen();
  auto reviews = store_->Reviews();
  ASSERT_TRUE(reviews) << reviews.error().message;
  ASSERT_THAT(*reviews, SizeIs(1));
  EXPECT_EQ(reviews->front().object, object);
  EXPECT_EQ(reviews->front().review.verdict, Verdict::kAccepted);
  EXPECT_EQ(reviews->front().review.note, "by the barn");
  EXPECT_EQ(reviews->front().review.updated_utc_us, 10);
  ASSERT_TRUE(store_->PutReview(object, {Verdict::kRejected, "", 20}));
  reviews = store_->Reviews();
  ASSERT_THAT(*reviews, SizeIs(1));
  EXPECT_EQ(reviews->front().review.verdict, Verdict::kRejected);
  ASSERT_TRUE(store_->PutReview(object, {}));
  EXPECT_TRUE(store_->Reviews()->empty());
  EXPECT_EQ(store_->PutReview(1234, {Verdict::kAccepted, "", 1}).error().code, ErrorCode::kNotFound);
}

// The same sightings by a new search: other ids, and the box a few pixels off.
TEST_P(ReviewsTest, ReviewSurvivesANewSearch) {
  const std::int64_t object = CommitOne(MakeBatch(0, 3, 0.5));
  ASSERT_TRUE(store_->PutReview(object, {Verdict::kRejected, "a shed", 10}));
  ASSERT_TRUE(store_->DeleteSearch(video_, model_));
  EXPECT_TRUE(store_->Reviews()->empty()) << "no object is there";
  IndexBatch again = MakeBatch(0, 3, 0.6);
  for (auto& one : again.sightings) one.sighting.box = {4, 4, 30, 40};
  const std::int64_t found = CommitOne(again);
  ASSERT_NE(found, object);
  ASSERT_THAT(*store_->Reviews(), SizeIs(1));
  EXPECT_EQ(store_->Reviews()->front().object, found);
  ASSERT_TRUE(store_->PutReview(found, {}));
  EXPECT_TRUE(store_->Reviews()->empty()) << "the review of the former search is replaced";

  ASSERT_TRUE(store_->PutReview(found, {Verdict::kAccepted, "", 20}));
  ASSERT_TRUE(store_->DeleteSearch(video_, model_));
  for (auto& one : again.sightings) one.sighting.box = {300, 200, 30, 40};
  CommitOne(again);
  EXPECT_TRUE(store_->Reviews()->empty()) << "another object, elsewhere in the frame";
}

TEST_P(ReviewsTest, ReviewFollowsJoinedAndPartedTracklets) {
  const std::int64_t a = CommitOne(MakeBatch(0, 2, 0.5));
  const std::int64_t b = CommitOne(MakeBatch(10, 2, 0.5));
  ASSERT_TRUE(store_->PutReview(a, {Verdict::kAccepted, "first", 10}));
  ASSERT_TRUE(store_->PutReview(b, {Verdict::kRejected, "second", 20}));
  const std::vector<ObjectRecord> joined = {{.id = a, .model = model_, .tracklets = {a, b}}};
  ASSERT_TRUE(store_->PutObjects(joined));
  auto reviews = store_->Reviews();
  ASSERT_THAT(*reviews, SizeIs(1));
  EXPECT_EQ(reviews->front().object, a);
  EXPECT_EQ(reviews->front().review.note, "second") << "the latest counts";
  ASSERT_TRUE(store_->PutReview(a, {Verdict::kAccepted, "both", 30}));
  const std::vector<ObjectRecord> parted = {{.id = a, .model = model_, .tracklets = {a}},
                                            {.id = b, .model = model_, .tracklets = {b}}};
  ASSERT_TRUE(store_->PutObjects(parted));
  reviews = store_->Reviews();
  ASSERT_THAT(*reviews, SizeIs(2));
  EXPECT_EQ(reviews->front().review.note, "both");
  EXPECT_EQ(reviews->back().review.note, "both");
}

// Each person has an own review; the team's is the latest with a verdict.
TEST_P(ReviewsTest, EachPersonDecidesAlone) {
  const std::int64_t object = CommitOne(MakeBatch(0, 3, 0.5));
  const auto team = [&]() -> Review {
    const auto reviews = store_->Reviews();
    EXPECT_TRUE(reviews) << reviews.error().message;
    return reviews && !reviews->empty() ? reviews->front().review : Review{};
  };
  const auto persons = [&] {
    std::vector<std::string> names;
    const auto decisions = store_->Decisions(object);
    EXPECT_TRUE(decisions) << decisions.error().message;
    for (const Review& one : *decisions) names.push_back(one.reviewer);
    return names;
  };
  ASSERT_TRUE(store_->PutReview(object, {Verdict::kAccepted, "mine", 10, "ann"}));
  ASSERT_TRUE(store_->PutReview(object, {Verdict::kRejected, "a shed", 20, "bob"}));
  EXPECT_EQ(team().reviewer, "bob");
  EXPECT_EQ(team().verdict, Verdict::kRejected);
  EXPECT_THAT(persons(), ElementsAre("bob", "ann"));
  EXPECT_EQ(store_->Decisions(object)->back().note, "mine");

  ASSERT_TRUE(store_->PutReview(object, {std::nullopt, "who knows", 30, "cid"}));
  EXPECT_EQ(team().reviewer, "bob") << "a note takes no verdict back";
  EXPECT_THAT(persons(), ElementsAre("cid", "bob", "ann"));

  ASSERT_TRUE(store_->PutReview(object, {std::nullopt, "", 40, "bob"}));
  EXPECT_EQ(team().reviewer, "ann") << "what bob took back";
  ASSERT_TRUE(store_->PutReview(object, {std::nullopt, "", 40, "ann"}));
  EXPECT_EQ(team().note, "who knows");
  EXPECT_THAT(persons(), ElementsAre("cid"));
  EXPECT_THAT(*store_->Decisions(1234), SizeIs(0));
}

// The clock of a server was set back, or those of two servers differ.
TEST_P(ReviewsTest, LaterDecisionIsTheNewerOneForAnyClock) {
  const std::int64_t object = CommitOne(MakeBatch(0, 5, 0.5));
  ASSERT_TRUE(store_->PutReview(object, {Verdict::kAccepted, "", 1'000, "ann"}));
  ASSERT_TRUE(store_->PutReview(object, {Verdict::kRejected, "", 400, "bob"}));
  EXPECT_EQ(store_->Decisions(object)->front().reviewer, "bob");
  EXPECT_EQ(store_->Reviews()->front().review.verdict, Verdict::kRejected);
  ASSERT_TRUE(store_->PutReview(object, {Verdict::kAccepted, "", 500, "bob"}));
  EXPECT_EQ(store_->Reviews()->front().review.verdict, Verdict::kAccepted);
  EXPECT_EQ(store_->Reviews()->front().review.reviewer, "bob");
  EXPECT_EQ(store_->Decisions(object)->front().updated_utc_us, 1'002) << "as late as it must be, not later";
}

TEST_P(ReviewsTest, DecisionsFollowJoinedAndPartedTracklets) {
  const std::int64_t a = CommitOne(MakeBatch(0, 2, 0.5));
  const std::int64_t b = CommitOne(MakeBatch(10, 2, 0.5));
  ASSERT_TRUE(store_->PutReview(a, {Verdict::kAccepted, "", 10, "ann"}));
  ASSERT_TRUE(store_->PutReview(b, {Verdict::kRejected, "", 20, "bob"}));
  ASSERT_TRUE(store_->PutReview(b, {Verdict::kAccepted, "again", 30, "ann"}));
  const std::vector<ObjectRecord> joined = {{.id = a, .model = model_, .tracklets = {a, b}}};
  ASSERT_TRUE(store_->PutObjects(joined));
  ASSERT_THAT(*store_->Decisions(a), SizeIs(2)) << "one a person, her latest";
  EXPECT_EQ(store_->Decisions(a)->front().note, "again");
  EXPECT_EQ(store_->Decisions(a)->back().reviewer, "bob");
  const std::vector<ObjectRecord> parted = {{.id = a, .model = model_, .tracklets = {a}},
                                            {.id = b, .model = model_, .tracklets = {b}}};
  ASSERT_TRUE(store_->PutObjects(parted));
  ASSERT_THAT(*store_->Decisions(a), SizeIs(1));
  EXPECT_EQ(store_->Decisions(a)->front().updated_utc_us, 10);
  EXPECT_THAT(*store_->Decisions(b), SizeIs(2));
  ASSERT_TRUE(store_->DeleteSearch(video_, model_));
  EXPECT_THAT(*store_->Decisions(b), SizeIs(0)) << "no object is there";
  CommitOne(MakeBatch(10, 2, 0.5));
  const std::int64_t found = store_->Reviews()->front().object;
  EXPECT_THAT(*store_->Decisions(found), SizeIs(2)) << "a new search finds it again";
}

TEST_P(ReviewsTest, ChangeNumberFollowsOtherConnections) {
  const auto other = OpenStore(name_, StoreMode::kCreate);
  ASSERT_TRUE(other);
  const auto before = store_->ChangeNumber();
  ASSERT_TRUE(before) << before.error().message;
  EXPECT_EQ(*store_->ChangeNumber(), *before);
  ASSERT_TRUE((*other)->PutVideo({.content_id = "c9", .name = "z.mp4", .width = 64, .height = 48}));
  EXPECT_NE(*store_->ChangeNumber(), *before);
}

VICTORIOUS_TEST_ON_ALL_STORES(ReviewsTest);

}  // namespace
}  // namespace victorious

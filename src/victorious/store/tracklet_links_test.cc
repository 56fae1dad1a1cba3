// What people say of the identity of tracklets, in an index, tested for every implementation.
#include <algorithm>
#include <tuple>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/data.h"
#include "testing/scratch_postgres.h"
#include "victorious/store/account_store.h"
#include "victorious/store/index_store.h"
#include "victorious/store/open_store.h"

namespace victorious {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::UnorderedElementsAre;

using Said = std::tuple<std::int64_t, std::int64_t, bool>;

class TrackletLinksTest : public ::testing::TestWithParam<testing::StoreKind> {
 protected:
  void SetUp() override {
    VICTORIOUS_STORE_OR_SKIP(name_, GetParam().make(folder_.path()));
    auto store = OpenStore(name_, StoreMode::kCreate);
    ASSERT_TRUE(store) << store.error().message;
    store_ = *std::move(store);
    video_ = store_->PutVideo({.content_id = "c1", .name = "a.mp4", .width = 640, .height = 480})->id;
    model_ = store_->PutModel({.name = "shed", .content_id = "m1", .kind = ModelKind::kPhotos})->id;
  }

  // A tracklet of three frames in a box of its own.
  std::int64_t Commit(int number, double shift_px = 0) {
    IndexBatch batch;
    batch.tracklets.push_back({.id = {}, .tracklet = {.video = video_, .model = model_, .frames = 3}});
    for (int frame = 10 * number; frame < 10 * number + 3; ++frame) {
      batch.sightings.push_back(
          {0, {.frame = frame, .box = {shift_px, 2, 30, 40}, .outline = {{1, 2}, {4, 2}, {4, 6}}, .score = 0.9}});
    }
    const auto ids = store_->Commit(batch);
    EXPECT_TRUE(ids) << ids.error().message;
    return ids ? ids->front() : -1;
  }

  [[nodiscard]] Expected<std::int64_t> Put(std::vector<std::vector<std::int64_t>> groups) {
    return store_->PutTrackletGroups({.groups = std::move(groups), .author = "ann", .made_utc_us = 7});
  }

  [[nodiscard]] std::vector<Said> Links() {
    const auto links = store_->TrackletLinks();
    EXPECT_TRUE(links) << links.error().message;
    std::vector<Said> said;
    for (const TrackletLink& link : links.value_or(std::vector<TrackletLink>()))
      said.emplace_back(link.first, link.second, link.is_one);
    return said;
  }

  testing::ScratchFolder folder_;
  std::string name_;
  std::unique_ptr<IndexStore> store_;
  std::int64_t video_ = 0;
  std::int64_t model_ = 0;
};

TEST_P(TrackletLinksTest, AreSoManyThatTheOthersFollow) {
  const std::int64_t a = Commit(0);
  const std::int64_t b = Commit(1);
  const std::int64_t c = Commit(2);
  EXPECT_THAT(Links(), IsEmpty());
  ASSERT_TRUE(Put({{a, b}, {c}}));
  EXPECT_THAT(Links(), UnorderedElementsAre(Said(a, b, true), Said(a, c, false)));
}

TEST_P(TrackletLinksTest, AreInTheOrderInWhichTheyWereSaidAndAreTakenBack) {
  const std::int64_t a = Commit(0);
  const std::int64_t b = Commit(1);
  ASSERT_TRUE(Put({{a}, {b}}));
  const auto joined = Put({{a, b}});
  ASSERT_TRUE(joined) << joined.error().message;
  EXPECT_THAT(Links(), ElementsAre(Said(a, b, false), Said(a, b, true))) << "the latest is last";
  ASSERT_TRUE(store_->DeleteTrackletGroups(*joined, "bob", 8));
  EXPECT_THAT(Links(), ElementsAre(Said(a, b, false)));
  const Status again = store_->DeleteTrackletGroups(*joined, "bob", 9);
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().code, ErrorCode::kNotFound);
}

TEST_P(TrackletLinksTest, SurviveANewSearchOfTheVideo) {
  const std::int64_t a = Commit(0);
  const std::int64_t b = Commit(1);
  const std::int64_t c = Commit(2);
  ASSERT_TRUE(Put({{a, b, c}}));
  ASSERT_TRUE(store_->DeleteSearch(video_, model_));
  EXPECT_THAT(Links(), ElementsAre(Said(-1, -2, true), Said(-1, -3, true))) << "of tracklets that may come again";
  Commit(0, 40);
  const std::int64_t second = Commit(1, 5);
  const std::int64_t third = Commit(2, 5);
  EXPECT_THAT(Links(), ElementsAre(Said(-1, second, true), Said(-1, third, true)))
      << "5 px beside; the first is another object, and the others are still one";
}

TEST_P(TrackletLinksTest, BelongToTheTrackletThatOverlapsMost) {
  const std::int64_t first = Commit(0, 4);
  const std::int64_t exact = Commit(0, 0);
  const std::int64_t other = Commit(1);
  ASSERT_TRUE(Put({{exact, other}}));
  EXPECT_THAT(Links(), ElementsAre(Said(exact, other, true)));
  ASSERT_TRUE(Put({{first}, {exact}}));
  EXPECT_THAT(Links(), ElementsAre(Said(exact, other, true), Said(first, exact, false)));
}

TEST_P(TrackletLinksTest, OfAnUnknownTrackletChangeNothing) {
  const std::int64_t a = Commit(0);
  const std::int64_t b = Commit(1);
  ASSERT_TRUE(Put({{a, b}}));
  const auto put = Put({{a}, {b}, {b + 1}});
  ASSERT_FALSE(put);
  EXPECT_EQ(put.error().code, ErrorCode::kNotFound);
  EXPECT_THAT(put.error().message, HasSubstr("moment"));
  EXPECT_THAT(Links(), ElementsAre(Said(a, b, true)));
}

TEST_P(TrackletLinksTest, AreInTheLog) {
  const std::int64_t a = Commit(0);
  const auto correction = Put({{a}, {Commit(1)}});
  ASSERT_TRUE(correction) << correction.error().message;
  ASSERT_TRUE(store_->DeleteTrackletGroups(*correction, "bob", 8));
  const auto log = OpenAccountStore(name_, StoreMode::kRead).value()->Audit(10, std::nullopt);
  ASSERT_TRUE(log) << log.error().message;
  ASSERT_THAT(*log, SizeIs(2));
  EXPECT_EQ(log->front().actor, "bob");
  EXPECT_EQ(log->front().action, "undo_regroup");
  EXPECT_EQ(log->back().actor, "ann");
  EXPECT_EQ(log->back().action, "regroup");
  EXPECT_EQ(log->back().time_utc_us, 7);
}

TEST_P(TrackletLinksTest, TheOptionsOfTheObjectsAreKept) {
  EXPECT_EQ(store_->AssociationOptions().value(), "");
  const auto update = [&](const std::string& json) {
    return store_->UpdateObjects(
        [&]() -> Expected<ObjectUpdate> {
          return ObjectUpdate{.objects = {}, .put_fits = {}, .deleted_fits = {}, .options_json = json};
        },
        CancelToken());
  };
  ASSERT_TRUE(update("{\"a\": 1}"));
  EXPECT_EQ(store_->AssociationOptions().value(), "{\"a\": 1}");
  ASSERT_TRUE(update("{}"));
  ASSERT_TRUE(update(""));
  EXPECT_EQ(store_->AssociationOptions().value(), "{}");
}

VICTORIOUS_TEST_ON_ALL_STORES(TrackletLinksTest);

}  // namespace
}  // namespace victorious

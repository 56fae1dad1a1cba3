#include "victorious/jobs/regroup_objects.h"

#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/data.h"
#include "victorious/jobs/association_options.h"
#include "victorious/place/associate/update_objects.h"

namespace victorious {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

class RegroupObjectsTest : public ::testing::Test {
 protected:
  RegroupObjectsTest() : store_(OpenSqliteStore(folder_ / "index.db", StoreMode::kCreate).value()) {
    video_ = store_->PutVideo({.content_id = "c1", .name = "a.mp4", .width = 640, .height = 480})->id;
    car_ = store_->PutModel({.name = "car", .content_id = "m1", .kind = ModelKind::kPhotos})->id;
  }

  // Four frames without telemetry: an object of its own.
  std::int64_t See(std::int64_t model, int first_frame) {
    IndexBatch batch;
    batch.tracklets.push_back({.id = {},
                               .tracklet = {.video = video_,
                                            .model = model,
                                            .score = 0.9,
                                            .frames = 4,
                                            .first_time_s = 0.1 * first_frame,
                                            .last_time_s = 0.1 * (first_frame + 3)}});
    for (int frame = first_frame; frame < first_frame + 4; ++frame) {
      batch.sightings.push_back({0,
                                 {.frame = frame,
                                  .time_s = 0.1 * frame,
                                  .box = {10.0 + first_frame, 20, 40, 30},
                                  .outline = {{1, 2}, {4, 2}, {4, 6}},
                                  .score = 0.9,
                                  .matches = 12}});
    }
    return store_->Commit(batch).value().front();
  }

  Expected<RegroupedObjects> RegroupAll(std::vector<std::vector<std::int64_t>> groups) {
    return RegroupObjects({.groups = std::move(groups), .author = "ann", .made_utc_us = 1}, *store_, CancelToken(), {});
  }

  std::vector<std::int64_t> Regroup(std::vector<std::vector<std::int64_t>> groups) {
    const auto regrouped = RegroupAll(std::move(groups));
    EXPECT_TRUE(regrouped) << regrouped.error().message;
    return regrouped ? regrouped->objects : std::vector<std::int64_t>();
  }

  std::string WhyNot(std::vector<std::vector<std::int64_t>> groups) {
    const auto regrouped = RegroupAll(std::move(groups));
    return regrouped ? "" : regrouped.error().message;
  }

  testing::ScratchFolder folder_;
  std::unique_ptr<IndexStore> store_;
  std::int64_t video_ = 0;
  std::int64_t car_ = 0;
};

TEST_F(RegroupObjectsTest, JoinsAndSplits) {
  const std::int64_t first = See(car_, 0);
  const std::int64_t second = See(car_, 40);
  const std::int64_t third = See(car_, 80);
  EXPECT_THAT(Regroup({{third, second, first}}), ElementsAre(first));
  auto objects = store_->Objects({.include_rejected = true}).value();
  ASSERT_THAT(objects, SizeIs(1));
  EXPECT_EQ(objects[0].frames, 12);
  EXPECT_THAT(Regroup({{second, first}, {third}}), ElementsAre(first, third));
  EXPECT_THAT(store_->Objects({.include_rejected = true}).value(), SizeIs(2));
  EXPECT_THAT(Regroup({{first}, {second}, {third}}), ElementsAre(first, second, third));
}

TEST_F(RegroupObjectsTest, IsTakenBackAsIfItHadNotBeenSaid) {
  const std::int64_t first = See(car_, 0);
  const std::int64_t second = See(car_, 40);
  const std::int64_t third = See(car_, 80);
  Regroup({{first}, {second}});
  const auto before = store_->TrackletLinks().value();
  const auto joined = RegroupAll({{first, second, third}});
  ASSERT_TRUE(joined) << joined.error().message;
  const auto objects = UndoRegrouping(
      joined->correction, {.groups = {{first}, {third}}, .author = "", .made_utc_us = 2}, *store_, CancelToken(), {});
  ASSERT_TRUE(objects) << objects.error().message;
  EXPECT_THAT(*objects, ElementsAre(first, third));
  EXPECT_EQ(store_->TrackletLinks()->size(), before.size()) << "the first two are apart, as was said before";
  EXPECT_FALSE(UndoRegrouping(joined->correction, {}, *store_, CancelToken(), {}));
}

// The two that are joined share no frame, but what was joined with one of them does.
TEST_F(RegroupObjectsTest, ARegroupingThatOthersStandAgainstIsNotKept) {
  const std::int64_t first = See(car_, 0);
  const std::int64_t beside = See(car_, 42);
  const std::int64_t second = See(car_, 40);
  Regroup({{first, beside}});
  EXPECT_THAT(WhyNot({{first, second}}), HasSubstr("share frames"));
  EXPECT_THAT(store_->TrackletLinks().value(), SizeIs(1));
  EXPECT_THAT(store_->Objects({.include_rejected = true}).value(), SizeIs(2)) << "as before";
}

TEST_F(RegroupObjectsTest, AReviewStaysWithItsMoment) {
  const std::int64_t first = See(car_, 0);
  const std::int64_t second = See(car_, 40);
  ASSERT_TRUE(store_->PutReview(second, {.verdict = Verdict::kAccepted, .note = "", .updated_utc_us = 5}));
  Regroup({{first, second}});
  ASSERT_THAT(store_->Reviews().value(), SizeIs(1));
  EXPECT_EQ(store_->Reviews().value()[0].object, first);
  Regroup({{first}, {second}});
  EXPECT_EQ(store_->Reviews().value()[0].object, second);
}

TEST_F(RegroupObjectsTest, RefusesAndKeepsNothingWrong) {
  const std::int64_t first = See(car_, 0);
  const std::int64_t beside = See(car_, 2);
  const std::int64_t other = See(store_->PutModel({.name = "van", .content_id = "m2"})->id, 0);
  const std::int64_t boxed = See(
      store_->PutModel({.name = "boxed/van", .content_id = std::string(kBoxedContentId), .kind = ModelKind::kCategory})
          ->id,
      50);
  const std::int64_t also_boxed = See(store_->Models()->back().id, 90);
  EXPECT_THAT(WhyNot({}), HasSubstr("fewer than two moments"));
  EXPECT_THAT(WhyNot({{first}}), HasSubstr("fewer than two moments"));
  EXPECT_THAT(WhyNot({{first, beside}, {}}), HasSubstr("no moment"));
  EXPECT_THAT(WhyNot({{first}, {first}}), HasSubstr("named twice"));
  EXPECT_THAT(WhyNot({{first, other}}), HasSubstr("different models"));
  EXPECT_THAT(WhyNot({{first, 999}}), HasSubstr("999 is not in the index"));
  EXPECT_EQ(WhyNot({{first, beside}}), "a.mp4 shows both at 0.20 s: they are two objects");
  EXPECT_THAT(WhyNot({{boxed, also_boxed}}), HasSubstr("boxed"));
  EXPECT_THAT(store_->TrackletLinks().value(), SizeIs(0));
}

TEST_F(RegroupObjectsTest, TheObjectsAreMadeByTheOptionsOfBefore) {
  const std::int64_t first = See(car_, 0);
  const std::int64_t second = See(car_, 40);
  const auto options = PrepareAssociation({.max_merge_distance_m = 4.5}, {.height_m = 512}, {}).value();
  ASSERT_TRUE(UpdateObjects(options, *store_, CancelToken(), [](const VideoRecord&, const FlightNotes&) {}));
  Regroup({{first, second}});
  const auto again = ReadAssociation(*store_, {}).value();
  EXPECT_EQ(again.max_merge_distance_m, 4.5);
  ASSERT_TRUE(again.ground);
  EXPECT_EQ(again.ground_id, options.ground_id);
  EXPECT_EQ(again.kept_json, options.kept_json);
}

}  // namespace
}  // namespace victorious

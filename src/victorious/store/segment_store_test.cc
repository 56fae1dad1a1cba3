// The segments of cut videos, tested for every implementation.
#include "victorious/store/segment_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/memory_segment_store.h"
#include "testing/scratch_postgres.h"
#include "victorious/store/open_store.h"
#include "victorious/store/postgres/postgres_segment_store.h"

namespace victorious {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::vector<std::byte> SegmentBytes(std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

std::string Text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

class SegmentStoreTest : public ::testing::TestWithParam<bool> {
 protected:
  void SetUp() override {
    if (!GetParam()) {
      segments_ = std::make_unique<testing::MemorySegmentStore>();
      return;
    }
    std::string url;
    VICTORIOUS_STORE_OR_SKIP(url, testing::EmptyPostgresDatabase());
    store_ = OpenStore(url, StoreMode::kCreate).value();
    video_ = store_->PutVideo({.content_id = "c1", .name = "a.mp4", .width = 640, .height = 480})->id;
    model_ = store_->PutModel({.name = "humvee", .content_id = "m1", .kind = ModelKind::kPhotos})->id;
    segments_ = OpenPostgresSegmentStore(url, StoreMode::kCreate).value();
  }

  // Two segments, of 240 and 100 frames.
  VideoCut TwoSegments(const std::string& plan = "plan") const {
    return {.video = video_,
            .plan = plan,
            .step = 60,
            .segments = {{{0, 240}, SegmentState::kOpen, ""}, {{240, 340}, SegmentState::kOpen, ""}}};
  }

  // Returns its id.
  std::int64_t Put(const VideoCut& cut, std::string_view prepared = "") {
    const auto id = segments_->Put(cut, std::span(&model_, 1), SegmentBytes(prepared));
    EXPECT_TRUE(id) << id.error().message;
    return id.value_or(0);
  }

  std::vector<Segment> Segments(std::int64_t cut) { return segments_->Find(cut).value()->segments; }

  std::vector<std::string> Results(std::int64_t cut) {
    std::vector<std::string> all;
    EXPECT_TRUE(segments_->VisitResults(cut, [&](FrameInterval frames, std::span<const std::byte> results) -> Status {
      all.push_back(std::to_string(frames.from) + " " + Text(results));
      return {};
    }));
    return all;
  }

  std::unique_ptr<IndexStore> store_;
  std::unique_ptr<SegmentStore> segments_;
  std::int64_t video_ = 1;
  std::int64_t model_ = 1;
};

TEST_P(SegmentStoreTest, ResultsComeInTheOrderOfFrames) {
  const std::int64_t cut = Put(TwoSegments(), "prepared");
  EXPECT_EQ(Text(segments_->Prepared(cut).value()), "prepared");
  EXPECT_EQ(segments_->Find(cut).value()->step, 60);
  ASSERT_TRUE(segments_->Complete(cut, {240, 340}, SegmentBytes("late")));
  EXPECT_THAT(Segments(cut),
              ElementsAre(Segment{{0, 240}, SegmentState::kOpen, ""}, Segment{{240, 340}, SegmentState::kDone, ""}));
  ASSERT_TRUE(segments_->Complete(cut, {0, 240}, SegmentBytes(std::string("\0early", 6))));
  EXPECT_THAT(Results(cut), ElementsAre(std::string("0 \0early", 8), "240 late"));
}

TEST_P(SegmentStoreTest, EachSegmentIsDoneOnce) {
  const std::int64_t cut = Put(TwoSegments());
  ASSERT_TRUE(segments_->Complete(cut, {0, 240}, SegmentBytes("first")));
  ASSERT_TRUE(segments_->Complete(cut, {0, 240}, SegmentBytes("second")));
  EXPECT_THAT(Results(cut), ElementsAre("0 first"));
  EXPECT_EQ(segments_->Complete(cut, {0, 120}, {}).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(segments_->Complete(cut + 1, {240, 340}, {}).error().code, ErrorCode::kNotFound);
}

// A process that stood still puts its cut again.
TEST_P(SegmentStoreTest, SameCutStays) {
  const std::int64_t cut = Put(TwoSegments(), "a");
  ASSERT_TRUE(segments_->Complete(cut, {0, 240}, SegmentBytes("x")));
  EXPECT_EQ(Put(TwoSegments(), "b"), cut);
  EXPECT_EQ(Text(segments_->Prepared(cut).value()), "a");
  EXPECT_THAT(Results(cut), ElementsAre("0 x"));
}

// Another build, or a model of other content under the same name: what was found before is out of date.
TEST_P(SegmentStoreTest, AnotherPlanForTheSameModelTakesItsPlace) {
  const std::int64_t cut = Put(TwoSegments(), "a");
  ASSERT_TRUE(segments_->Complete(cut, {0, 240}, SegmentBytes("x")));
  const std::int64_t other = Put(TwoSegments("other"), "c");
  EXPECT_NE(other, cut);
  EXPECT_EQ(Text(segments_->Prepared(other).value()), "c");
  EXPECT_THAT(Results(other), IsEmpty());
  EXPECT_EQ(segments_->Find(cut).value(), std::nullopt);
  EXPECT_EQ(segments_->Complete(cut, {240, 340}, {}).error().code, ErrorCode::kNotFound);
  EXPECT_TRUE(segments_->GiveUp(cut, {240, 340}, "signal 11"));
  EXPECT_EQ(Segments(other).back().state, SegmentState::kOpen);
  const auto visit = [](FrameInterval, std::span<const std::byte>) { return Status(); };
  EXPECT_EQ(segments_->VisitResults(cut, visit).error().code, ErrorCode::kNotFound);
}

TEST_P(SegmentStoreTest, SearchesForOtherModelsAreCutBesides) {
  const std::int64_t cut = Put(TwoSegments(), "a");
  const std::int64_t other_model = model_ + 1;
  const auto other = segments_->Put(TwoSegments("other"), std::span(&other_model, 1), SegmentBytes("c"));
  ASSERT_TRUE(other) << other.error().message;
  ASSERT_TRUE(segments_->Complete(cut, {0, 240}, SegmentBytes("x")));
  EXPECT_THAT(Results(cut), ElementsAre("0 x"));
  EXPECT_THAT(Results(*other), IsEmpty());
  const std::vector<VideoCut> both = segments_->CutsOf(video_).value();
  ASSERT_EQ(both.size(), 2U);
  EXPECT_EQ(both[0].id, cut);
  EXPECT_EQ(both[1].plan, "other");
  ASSERT_TRUE(segments_->Finish(cut, {}));
  EXPECT_THAT(segments_->CutsOf(video_).value(), ElementsAre(both[1]));
}

TEST_P(SegmentStoreTest, EachSegmentHasWhatItNeeds) {
  const std::vector<std::vector<std::byte>> own = {SegmentBytes("first"), SegmentBytes("second")};
  const std::int64_t cut = segments_->Put(TwoSegments(), std::span(&model_, 1), SegmentBytes("all"), own).value();
  EXPECT_EQ(segments_->PreparedOf(cut, {0, 240}).value(), own[0]);
  EXPECT_EQ(segments_->PreparedOf(cut, {240, 340}).value(), own[1]);
  EXPECT_EQ(segments_->PreparedOf(cut, {0, 120}).error().code, ErrorCode::kNotFound);
  ASSERT_TRUE(segments_->GiveUp(cut, {0, 240}, "signal 11"));
  EXPECT_EQ(segments_->PreparedOf(cut, {0, 120}).value(), own[0]);
  EXPECT_EQ(segments_->PreparedOf(cut, {120, 240}).value(), own[0]);
  ASSERT_TRUE(segments_->Complete(cut, {120, 240}, SegmentBytes("x")));
  EXPECT_EQ(segments_->PreparedOf(cut, {120, 240}).error().code, ErrorCode::kNotFound) << "it is done";
}

TEST_P(SegmentStoreTest, JoinedResultsAreDiscarded) {
  const std::int64_t cut = Put(TwoSegments());
  ASSERT_TRUE(segments_->Complete(cut, {0, 240}, SegmentBytes("a")));
  ASSERT_TRUE(segments_->Complete(cut, {240, 340}, SegmentBytes("b")));
  ASSERT_TRUE(segments_->Discard(cut, 239));
  EXPECT_THAT(Results(cut), ElementsAre("0 a", "240 b"));
  ASSERT_TRUE(segments_->Discard(cut, 240));
  EXPECT_THAT(Results(cut), ElementsAre("240 b"));
  EXPECT_EQ(Segments(cut).front().state, SegmentState::kDone);
}

TEST_P(SegmentStoreTest, GivenUpSegmentIsCutDownToTheSmallest) {
  const std::int64_t cut = Put(TwoSegments());
  for (const FrameInterval frames : {FrameInterval{0, 240}, {120, 240}, {120, 180}, {120, 180}, {0, 240}}) {
    ASSERT_TRUE(segments_->GiveUp(cut, frames, "signal 11"));
  }
  EXPECT_THAT(Segments(cut),
              ElementsAre(Segment{{0, 120}, SegmentState::kOpen, ""},
                          Segment{{120, 180}, SegmentState::kQuarantined, "signal 11"},
                          Segment{{180, 240}, SegmentState::kOpen, ""}, Segment{{240, 340}, SegmentState::kOpen, ""}));
  EXPECT_THAT(segments_->Quarantined().value(),
              ElementsAre(QuarantinedSegment{.video = video_, .frames = {120, 180}, .reason = "signal 11"}));
  ASSERT_TRUE(segments_->GiveUp(cut, {240, 340}, "signal 9"));
  EXPECT_EQ(Segments(cut).back().frames, (FrameInterval{300, 340}));
  ASSERT_TRUE(segments_->Complete(cut, {0, 120}, {}));
  ASSERT_TRUE(segments_->GiveUp(cut, {0, 120}, "late"));
  EXPECT_EQ(Segments(cut).front().state, SegmentState::kDone);
  ASSERT_TRUE(segments_->Complete(cut, {120, 180}, SegmentBytes("late")));
  EXPECT_EQ(Segments(cut)[1].state, SegmentState::kQuarantined) << "what is left out stays a gap";
}

TEST_P(SegmentStoreTest, FinishLeavesTheGaps) {
  if (store_) {
    IndexBatch batch;
    batch.progress.push_back({.search = {.video = video_,
                                         .model = model_,
                                         .next_frame = 340,
                                         .finished = true,
                                         .options_json = "{}",
                                         .program_version = "1"},
                              .expected_next_frame = 0});
    ASSERT_TRUE(store_->Commit(batch));
  }
  const std::int64_t cut = Put(TwoSegments());
  const CoverageGap gap{.video = video_, .frames = {120, 180}, .from_s = 12, .to_s = 17.9, .reason = "signal 11"};
  ASSERT_TRUE(segments_->Finish(cut + 1, std::span(&gap, 1)));
  EXPECT_THAT(segments_->Gaps().value(), IsEmpty());
  ASSERT_TRUE(segments_->Finish(cut, std::span(&gap, 1)));
  EXPECT_THAT(segments_->Gaps().value(), ElementsAre(gap));
  EXPECT_EQ(segments_->Find(cut).value(), std::nullopt);
  EXPECT_EQ(segments_->Prepared(cut).error().code, ErrorCode::kNotFound);
  if (!store_) return;
  ASSERT_TRUE(store_->DeleteSearch(video_, model_));
  EXPECT_THAT(segments_->Gaps().value(), IsEmpty()) << "it is searched again";
}

TEST_P(SegmentStoreTest, VideoMayHaveToStayWhole) {
  const std::int64_t cut = Put(TwoSegments());
  if (store_) {
    IndexBatch batch;
    batch.progress.push_back({.search = {.video = video_,
                                         .model = model_,
                                         .next_frame = 240,
                                         .finished = false,
                                         .options_json = "{}",
                                         .program_version = "1"},
                              .expected_next_frame = 0});
    ASSERT_TRUE(store_->Commit(batch));
  }
  ASSERT_TRUE(segments_->SetWhole(cut + 1));
  EXPECT_FALSE(segments_->Find(cut).value()->is_whole);
  ASSERT_TRUE(segments_->SetWhole(cut));
  EXPECT_TRUE(segments_->Find(cut).value()->is_whole);
  if (!store_) return;
  EXPECT_FALSE(store_->FindSearch(video_, model_).value()) << "what was joined may have other numbers of frames";
}

INSTANTIATE_TEST_SUITE_P(Memory, SegmentStoreTest, ::testing::Values(false));
INSTANTIATE_TEST_SUITE_P(Postgres, SegmentStoreTest, ::testing::Values(true));

TEST(MiddleOf, LiesAtAMultipleOfTheStep) {
  EXPECT_EQ(MiddleOf({0, 600}, 60), 300);
  EXPECT_EQ(MiddleOf({120, 300}, 60), 240);
  EXPECT_EQ(MiddleOf({0, 61}, 60), 60);
  EXPECT_EQ(MiddleOf({60, 120}, 60), std::nullopt);
  EXPECT_EQ(MiddleOf({0, 60}, 10), std::nullopt) << "60 frames are the least";
  EXPECT_EQ(MiddleOf({0, 90}, 100), std::nullopt);
}

}  // namespace
}  // namespace victorious

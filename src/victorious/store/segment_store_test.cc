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

std::vector<std::byte> Bytes(std::string_view text) {
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

  std::vector<Segment> Segments() { return segments_->Find(video_).value()->segments; }

  std::vector<std::string> Results() {
    std::vector<std::string> all;
    EXPECT_TRUE(
        segments_->VisitResults(video_, [&](FrameInterval frames, std::span<const std::byte> results) -> Status {
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
  ASSERT_TRUE(segments_->Put(TwoSegments(), Bytes("prepared")));
  EXPECT_EQ(Text(segments_->Prepared(video_).value()), "prepared");
  EXPECT_EQ(segments_->Find(video_).value()->step, 60);
  ASSERT_TRUE(segments_->Complete(video_, "plan", {240, 340}, Bytes("late")));
  EXPECT_THAT(Segments(),
              ElementsAre(Segment{{0, 240}, SegmentState::kOpen, ""}, Segment{{240, 340}, SegmentState::kDone, ""}));
  ASSERT_TRUE(segments_->Complete(video_, "plan", {0, 240}, Bytes(std::string("\0early", 6))));
  EXPECT_THAT(Results(), ElementsAre(std::string("0 \0early", 8), "240 late"));
}

TEST_P(SegmentStoreTest, EachSegmentIsDoneOnce) {
  ASSERT_TRUE(segments_->Put(TwoSegments(), {}));
  ASSERT_TRUE(segments_->Complete(video_, "plan", {0, 240}, Bytes("first")));
  ASSERT_TRUE(segments_->Complete(video_, "plan", {0, 240}, Bytes("second")));
  EXPECT_THAT(Results(), ElementsAre("0 first"));
  EXPECT_EQ(segments_->Complete(video_, "plan", {0, 120}, {}).error().code, ErrorCode::kConflict);
  EXPECT_EQ(segments_->Complete(video_, "other", {240, 340}, {}).error().code, ErrorCode::kConflict);
}

// A process that stood still puts its cut again.
TEST_P(SegmentStoreTest, SameCutStays) {
  ASSERT_TRUE(segments_->Put(TwoSegments(), Bytes("a")));
  ASSERT_TRUE(segments_->Complete(video_, "plan", {0, 240}, Bytes("x")));
  ASSERT_TRUE(segments_->Put(TwoSegments(), Bytes("b")));
  EXPECT_EQ(Text(segments_->Prepared(video_).value()), "a");
  EXPECT_THAT(Results(), ElementsAre("0 x"));
  ASSERT_TRUE(segments_->Put(TwoSegments("other"), Bytes("c")));
  EXPECT_EQ(Text(segments_->Prepared(video_).value()), "c");
  EXPECT_THAT(Results(), IsEmpty());
}

TEST_P(SegmentStoreTest, GivenUpSegmentIsCutDownToTheSmallest) {
  ASSERT_TRUE(segments_->Put(TwoSegments(), {}));
  for (const FrameInterval frames : {FrameInterval{0, 240}, {120, 240}, {120, 180}, {120, 180}, {0, 240}}) {
    ASSERT_TRUE(segments_->GiveUp(video_, frames, "signal 11"));
  }
  EXPECT_THAT(Segments(),
              ElementsAre(Segment{{0, 120}, SegmentState::kOpen, ""},
                          Segment{{120, 180}, SegmentState::kQuarantined, "signal 11"},
                          Segment{{180, 240}, SegmentState::kOpen, ""}, Segment{{240, 340}, SegmentState::kOpen, ""}));
  ASSERT_TRUE(segments_->GiveUp(video_, {240, 340}, "signal 9"));
  EXPECT_EQ(Segments().back().frames, (FrameInterval{300, 340}));
  ASSERT_TRUE(segments_->Complete(video_, "plan", {0, 120}, {}));
  ASSERT_TRUE(segments_->GiveUp(video_, {0, 120}, "late"));
  EXPECT_EQ(Segments().front().state, SegmentState::kDone);
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
  ASSERT_TRUE(segments_->Put(TwoSegments(), {}));
  const CoverageGap gap{.video = video_, .frames = {120, 180}, .from_s = 12, .to_s = 17.9, .reason = "signal 11"};
  const std::vector<std::int64_t> models = {model_};
  ASSERT_TRUE(segments_->Finish(video_, "other", models, std::span(&gap, 1)));
  EXPECT_THAT(segments_->Gaps().value(), IsEmpty());
  ASSERT_TRUE(segments_->Finish(video_, "plan", models, std::span(&gap, 1)));
  EXPECT_THAT(segments_->Gaps().value(), ElementsAre(gap));
  EXPECT_EQ(segments_->Find(video_).value(), std::nullopt);
  EXPECT_EQ(segments_->Prepared(video_).error().code, ErrorCode::kNotFound);
  if (!store_) return;
  ASSERT_TRUE(store_->DeleteSearch(video_, model_));
  EXPECT_THAT(segments_->Gaps().value(), IsEmpty()) << "it is searched again";
}

TEST_P(SegmentStoreTest, VideoMayHaveToStayWhole) {
  ASSERT_TRUE(segments_->Put(TwoSegments(), {}));
  ASSERT_TRUE(segments_->SetWhole(video_, "other"));
  EXPECT_FALSE(segments_->Find(video_).value()->is_whole);
  ASSERT_TRUE(segments_->SetWhole(video_, "plan"));
  EXPECT_TRUE(segments_->Find(video_).value()->is_whole);
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

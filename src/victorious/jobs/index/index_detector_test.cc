// An imported detector in an index: it searches some frames, and what it finds is tracked in between.
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "testing/data.h"
#include "testing/drawn_flight.h"
#include "testing/fault_injecting_store.h"
#include "testing/tiny_detector.h"
#include "victorious/input/video/video_writer.h"
#include "victorious/jobs/index/indexer.h"
#include "victorious/store/open_store.h"

namespace victorious {
namespace {

using testing::Contents;
using testing::FaultInjectingStore;
using testing::SightingsOf;

constexpr int kDetectorFrames = 84;  // beyond the restart of all tracks
constexpr int kDetectorInterval = 5;
constexpr int kDetected_px = 40;

class IndexDetectorTest : public ::testing::Test {
 protected:
  // A red object with texture on grey ground, which moves by 2 px a frame.
  void SetUp() override {
    auto writer = VideoWriter::Create(video_, {.width = 256, .height = 128, .fps = 10});
    ASSERT_TRUE(writer) << writer.error().message;
    for (int i = 0; i < kDetectorFrames; ++i) {
      cv::Mat bgr(128, 256, CV_8UC3, cv::Scalar(90, 90, 90));
      cv::Mat object = bgr(cv::Rect(XOf(i), 40, kDetected_px, kDetected_px));
      object = cv::Scalar(0, 0, 250);
      for (int k = 0; k < 8; ++k) object(cv::Rect(5 * (k % 4) + 6, 8 * (k / 2) + 3, 4, 4)) = cv::Scalar(0, 0, 170);
      ASSERT_TRUE((*writer)->Write(bgr));
    }
    ASSERT_TRUE((*writer)->Finish());
    DetectorModel model{.source = "tiny.onnx", .classes = {"red", "blue"}};
    model.files.network = testing::TinyDetectorOnnx(64);
    auto imported = ImportDetector(std::move(model), {.min_score = 0.5});
    ASSERT_TRUE(imported) << imported.error().message;
    model_ = *std::move(imported);
  }

  static int XOf(int frame) { return 20 + 2 * frame; }

  Expected<IndexReport> TryIndex(IndexStore& store, const IndexOptions& options = {}, const CancelToken& cancel = {}) {
    VICTORIOUS_ASSIGN_OR_RETURN(const Indexer indexer, Indexer::Create({}, options, model_));
    return indexer.Index({.video = video_,
                          .telemetry = {},
                          .threads = 2,
                          .inform = [this](const std::string& line) { informed_ += line + "\n"; }},
                         cancel, store);
  }

  [[nodiscard]] std::unique_ptr<IndexStore> Store(std::string_view name) const {
    return OpenStore((folder_ / name).string(), StoreMode::kCreate).value();
  }

  testing::ScratchFolder folder_;
  std::string video_ = (folder_ / "red.mkv").string();
  DetectorModel model_;
  std::string informed_;
};

TEST_F(IndexDetectorTest, SearchesSomeFramesAndTracksInBetween) {
  const auto store = Store("index.db");
  const auto report = TryIndex(*store);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(report->frames_searched, (kDetectorFrames + kDetectorInterval - 1) / kDetectorInterval);
  EXPECT_THAT(informed_, ::testing::HasSubstr("one of 5 frames is searched, and what is found is tracked in between"));
  const std::vector<SightingRecord> sightings = SightingsOf(*store, {.category_name = "red"});
  std::set<std::int64_t> tracked;
  for (const SightingRecord& one : sightings) {
    const bool is_searched = one.frame % kDetectorInterval == 0;
    EXPECT_EQ(one.source, is_searched ? SightingSource::kRecognised : SightingSource::kTracked) << one.frame;
    const Box object{static_cast<double>(XOf(static_cast<int>(one.frame))), 40, kDetected_px, kDetected_px};
    EXPECT_GT(Intersection(one.box, object).Area(), 0) << one.frame;
    if (!is_searched) tracked.insert(one.frame);
  }
  EXPECT_GT(tracked.size(), kDetectorFrames / 2);
  EXPECT_TRUE(SightingsOf(*store, {.category_name = "blue"}).empty());
}

TEST_F(IndexDetectorTest, EveryNSetsTheInterval) {
  const auto store = Store("index.db");
  IndexOptions options;
  options.every = 20;
  const auto report = TryIndex(*store, options);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(report->frames_searched, 5);
}

TEST_F(IndexDetectorTest, IntervalIsATime) {
  const auto store = Store("index.db");
  IndexOptions options;
  options.detector.interval_s = 2;
  const auto report = TryIndex(*store, options);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(report->frames_searched, 5);
}

TEST_F(IndexDetectorTest, WithoutTrackingEveryFrameIsSearched) {
  const auto store = Store("index.db");
  IndexOptions options;
  options.follow.enabled = false;
  const auto report = TryIndex(*store, options);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(report->frames_searched, kDetectorFrames);
  for (const SightingRecord& one : SightingsOf(*store)) EXPECT_EQ(one.source, SightingSource::kRecognised);
}

TEST_F(IndexDetectorTest, ResumedSearchEqualsUninterruptedSearch) {
  IndexOptions options;
  options.keep.interval_s = 0;  // so that frames are stored before the end of the video
  options.every = 2;
  const auto whole = Store("whole.db");
  ASSERT_TRUE(TryIndex(*whole, options));
  const auto parts = Store("parts.db");
  CancelToken cancel;
  FaultInjectingStore hooked(*parts, [&]() -> Status {
    cancel.Cancel();
    return {};
  });
  ASSERT_FALSE(TryIndex(hooked, options, cancel));
  const std::int64_t done = parts->FindSearch(1, 1).value().value().next_frame;
  EXPECT_GT(done, 60);  // beyond the restart of all tracks, between two searches or at one
  EXPECT_LT(done, kDetectorFrames);
  ASSERT_TRUE(TryIndex(*parts, options));
  EXPECT_EQ(Contents(*parts), Contents(*whole));
}

}  // namespace
}  // namespace victorious

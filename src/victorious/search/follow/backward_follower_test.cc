#include "victorious/search/follow/backward_follower.h"

#include <algorithm>
#include <utility>

#include <gtest/gtest.h>

#include "testing/drawn_flight.h"

namespace victorious {
namespace {

using testing::DrawnFlight;
using testing::ShortFlight;

// Some frames of a flight, of which only the last one is searched completely.
class BackwardFollowerTest : public ::testing::Test {
 protected:
  static constexpr int kFirstFrame = 14;
  static constexpr int kFrames = 12;
  static constexpr std::int64_t kFirstTrack = 7;  // id of the first track that starts in the last frame

  [[nodiscard]] FollowedFrame MakeFrame(int i) const {
    const int index = kFirstFrame + i;
    cv::Mat grey;
    cv::cvtColor(flight_.flight().Render(index).image, grey, cv::COLOR_BGR2GRAY);
    return {.frame = {.index = index, .time_s = 0.1 * index, .image = grey}, .conditions = {}, .objects = {}};
  }

  void SearchLastFrame() {
    now_ = MakeFrame(kFrames - 1);
    features_ = extractor_->Extract(now_.frame.image).value();
    std::vector<Detection> detections = recognizer_.Recognize(features_).value();
    for (Detection& detection : detections) {
      const auto track = kFirstTrack + std::ssize(now_.objects);
      now_.objects.push_back(
          {.detection = std::move(detection), .features = features_, .track = track, .starts_track = true});
    }
    ASSERT_FALSE(now_.objects.empty());
  }

  [[nodiscard]] Status Follow() {
    std::vector<FollowedFrame*> nearest_first;
    for (int i = kFrames - 2; i >= 0; --i) nearest_first.push_back(&before_[static_cast<std::size_t>(i)]);
    return FollowBackward(recognizer_, *extractor_, {}, now_, features_, nearest_first);
  }

  void SetUp() override {
    for (int i = 0; i + 1 < kFrames; ++i) before_.push_back(MakeFrame(i));
    SearchLastFrame();
  }

  DrawnFlight flight_{ShortFlight(40)};
  std::unique_ptr<const FeatureExtractor> extractor_ = MakeFeatureExtractor(LowContrastFeatureOptions()).value();
  Recognizer recognizer_ = Recognizer::Create(flight_.Models(), FeatureOptions().engine, {}).value();
  FollowedFrame now_;
  FeatureSet features_;
  std::vector<FollowedFrame> before_;  // in order of time
};

TEST_F(BackwardFollowerTest, AddsTheObjectToTheFramesBefore) {
  ASSERT_TRUE(Follow());
  int visible = 0;
  int found = 0;
  for (const FollowedFrame& past : before_) {
    for (const testing::TruthRow& row : flight_.flight().Truth(static_cast<int>(past.frame.index))) {
      const auto is_of_model = [&](const ObservedObject& one) {
        return recognizer_.models()[one.detection.model_index].name == row.model;
      };
      if (row.visible < 0.8 || std::ranges::none_of(now_.objects, is_of_model)) continue;
      ++visible;
      found += std::ranges::any_of(past.objects, [&](const ObservedObject& one) {
        return is_of_model(one) && IntersectionOverUnion(one.detection.box, row.box) > 0.5;
      });
    }
    for (const ObservedObject& one : past.objects) {
      ASSERT_TRUE(one.track);
      const ObservedObject& start = now_.objects.at(static_cast<std::size_t>(*one.track - kFirstTrack));
      EXPECT_EQ(one.detection.model_index, start.detection.model_index);
      EXPECT_LE(one.detection.score, start.detection.score) << "a region is no surer than what its track rests on";
      EXPECT_FALSE(one.starts_track);
    }
  }
  ASSERT_GT(visible, 5);
  EXPECT_GE(found, 0.8 * visible);
}

TEST_F(BackwardFollowerTest, StopsAtAnObjectThatIsKnown) {
  ASSERT_TRUE(Follow());
  constexpr std::size_t kKnownIn = 6;
  const std::vector<ObservedObject> known = before_[kKnownIn].objects;
  ASSERT_FALSE(known.empty());
  for (FollowedFrame& past : before_) past.objects.clear();
  before_[kKnownIn].objects = known;
  ASSERT_TRUE(Follow());
  EXPECT_EQ(before_[kKnownIn].objects.size(), known.size());
  EXPECT_FALSE(before_[kKnownIn + 1].objects.empty());
  for (std::size_t i = 0; i < kKnownIn; ++i) {
    for (const ObservedObject& one : before_[i].objects) {
      EXPECT_TRUE(std::ranges::none_of(known, [&](const ObservedObject& other) { return other.track == one.track; }));
    }
  }
}

TEST_F(BackwardFollowerTest, FollowsOnlyWhatStartsATrack) {
  for (ObservedObject& object : now_.objects) object.starts_track = false;
  ASSERT_TRUE(Follow());
  for (const FollowedFrame& past : before_) EXPECT_TRUE(past.objects.empty());
}

TEST(HeldFrameCount, IsBoundedByOptionAndMemory) {
  FollowOptions options;
  options.backward_frames = 20;
  EXPECT_EQ(HeldFrameCount(options, 640UL * 480), 20);
  EXPECT_EQ(HeldFrameCount(options, 3840UL * 2160), 7) << "64 MB";
  EXPECT_EQ(HeldFrameCount(options, 1'000'000'000), 1);
  options.backward_frames = 0;
  EXPECT_EQ(HeldFrameCount(options, 640UL * 480), 0);
}

}  // namespace
}  // namespace victorious

#include "victorious/search/follow/follower.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include <gtest/gtest.h>

#include "testing/drawn_flight.h"

namespace victorious {
namespace {

using testing::DrawnFlight;
using testing::ShortFlight;

// One flight and its follower; full-frame searches at a fixed interval.
class FollowerTest : public ::testing::Test {
 protected:
  static constexpr int kFrames = 24;

  struct Frames {
    std::vector<std::vector<ObservedObject>> seen;  // by frame
    int truths = 0;                                 // number of clearly visible objects, over all frames
    int found = 0;                                  // of these
  };

  Frames FollowAll(int every, const FollowOptions& options, double frame_rate = 10,
                   RegionSearches searches = RegionSearches::kAllDue) {
    Frames result;
    Follower follower = Follower::Create(recognizer_, *extractor_, options).value();
    for (int i = 0; i < kFrames; ++i) {
      cv::Mat grey;
      cv::cvtColor(flight_.flight().Render(i).image, grey, cv::COLOR_BGR2GRAY);
      const Frame frame{.index = i, .time_s = i / frame_rate, .image = grey};
      const FeatureSet features = extractor_->Extract(grey).value();
      const std::vector<Detection> detections = recognizer_.Recognize(features).value();
      std::optional<FullFrameResult> whole;
      if (i % every == 0) whole.emplace(features, detections);
      result.seen.push_back(follower.Follow(frame, whole, {}, searches).value());
      for (const testing::TruthRow& row : flight_.flight().Truth(i)) {
        if (row.visible < 0.8) continue;
        ++result.truths;
        result.found += std::ranges::any_of(result.seen.back(), [&](const ObservedObject& seen) {
          return IntersectionOverUnion(seen.detection.box, row.box) > 0.5;
        });
      }
    }
    return result;
  }

  DrawnFlight flight_{ShortFlight(kFrames)};
  std::unique_ptr<const FeatureExtractor> extractor_ = MakeFeatureExtractor(LowContrastFeatureOptions()).value();
  Recognizer recognizer_ = Recognizer::Create(flight_.Models(), FeatureOptions().engine, {}).value();
};

TEST_F(FollowerTest, ATrackIsFollowedUntilItIsStopped) {
  cv::Mat grey;
  cv::cvtColor(flight_.flight().Render(0).image, grey, cv::COLOR_BGR2GRAY);
  const FeatureSet features = extractor_->Extract(grey).value();
  const std::vector<Detection> detections = recognizer_.Recognize(features).value();
  Follower follower = Follower::Create(recognizer_, *extractor_, {}).value();
  const std::vector<ObservedObject> seen =
      follower.Follow({.index = 0, .time_s = 0, .image = grey}, FullFrameResult{features, detections}, {}).value();
  ASSERT_FALSE(seen.empty());
  ASSERT_TRUE(seen[0].track);
  EXPECT_TRUE(follower.IsFollowed(*seen[0].track));
  follower.Stop(*seen[0].track);
  EXPECT_FALSE(follower.IsFollowed(*seen[0].track));
}

TEST_F(FollowerTest, ObjectsAreRecognisedInTheirRegionsBetweenFullFrames) {
  const Frames frames = FollowAll(6, {});
  ASSERT_GT(frames.truths, 10);
  EXPECT_GE(frames.found, 0.8 * frames.truths);
  int recognised_between = 0;
  for (int i = 0; i < kFrames; ++i) {
    for (const ObservedObject& seen : frames.seen[i]) recognised_between += i % 6 != 0 && !seen.tracked() ? 1 : 0;
  }
  EXPECT_GT(recognised_between, 5) << "the recogniser confirms the track";
}

TEST_F(FollowerTest, RegionsAreSearchedByTimeAndNotByFrame) {
  const Frames frames = FollowAll(6, {}, 30);
  struct Recognitions {
    int count = 0;
    int last_frame = 0;
  };
  std::map<std::int64_t, Recognitions> of_track;
  int tracked = 0;
  int recognised_between = 0;
  for (int i = 0; i < kFrames; ++i) {
    for (const ObservedObject& seen : frames.seen[i]) {
      tracked += seen.tracked() ? 1 : 0;
      if (seen.tracked() || !seen.track) continue;
      Recognitions& recognitions = of_track[*seen.track];
      if (recognitions.count >= FollowOptions().min_recognised_frames && i % 6 != 0) {
        EXPECT_GE(i - recognitions.last_frame, 3) << "a tenth of a second";
        ++recognised_between;
      }
      ++recognitions.count;
      recognitions.last_frame = i;
    }
  }
  EXPECT_GT(recognised_between, 3);
  EXPECT_GT(tracked, recognised_between);
  EXPECT_GE(frames.found, 0.8 * frames.truths);
}

TEST_F(FollowerTest, WithoutTimeOnlyUnconfirmedTracksAreSearched) {
  const Frames frames = FollowAll(6, {}, 10, RegionSearches::kUnconfirmedOnly);
  std::map<std::int64_t, int> recognitions;  // by track
  int tracked = 0;
  for (int i = 0; i < kFrames; ++i) {
    for (const ObservedObject& seen : frames.seen[i]) {
      if (!seen.track) continue;
      tracked += seen.tracked() ? 1 : 0;
      int& count = recognitions[*seen.track];
      if (seen.tracked()) continue;
      EXPECT_TRUE(i % 6 == 0 || count < FollowOptions().min_recognised_frames);
      ++count;
    }
  }
  EXPECT_GT(tracked, 10);
  EXPECT_GE(frames.found, 0.8 * frames.truths);
}

// A detection in a predicted region confirms the position; its score is capped by the full-frame score.
TEST_F(FollowerTest, RegionScoreIsCappedByFullFrameScore) {
  constexpr double kScore = 0.85;
  Follower follower = Follower::Create(recognizer_, *extractor_, {}).value();
  int between = 0;
  for (int i = 0; i < kFrames; ++i) {
    cv::Mat grey;
    cv::cvtColor(flight_.flight().Render(i).image, grey, cv::COLOR_BGR2GRAY);
    const FeatureSet features = extractor_->Extract(grey).value();
    std::vector<Detection> detections = recognizer_.Recognize(features).value();
    for (Detection& detection : detections) detection.score = kScore;
    std::optional<FullFrameResult> whole;
    if (i % 6 == 0) whole.emplace(features, detections);
    const std::vector<ObservedObject> seen =
        follower.Follow({.index = i, .time_s = 0.1 * i, .image = grey}, whole, {}).value();
    for (const ObservedObject& one : seen) {
      EXPECT_LE(one.detection.score, kScore);
      between += i % 6 != 0 && !one.tracked() ? 1 : 0;
    }
  }
  EXPECT_GT(between, 5);
}

TEST_F(FollowerTest, ObjectIsReportedOncePerFrame) {
  for (const std::vector<ObservedObject>& seen : FollowAll(3, {}).seen) {
    for (std::size_t i = 0; i < seen.size(); ++i) {
      for (std::size_t k = 0; k < i; ++k) {
        if (seen[i].detection.model_index != seen[k].detection.model_index) continue;
        EXPECT_LT(IntersectionOverUnion(seen[i].detection.box, seen[k].detection.box), 0.3);
      }
    }
  }
}

TEST_F(FollowerTest, RarelyRecognisedTrackIsNotReportedAlone) {
  FollowOptions strict;
  strict.min_recognised_frames = 1000;
  for (const std::vector<ObservedObject>& seen : FollowAll(4, strict).seen) {
    for (const ObservedObject& one : seen) EXPECT_FALSE(one.tracked());
  }
}

TEST_F(FollowerTest, TrackedSightingHasTheTrackedPointsAsInliers) {
  FollowOptions seldom;
  seldom.search_interval_s = 0.4;
  int tracked = 0;
  for (const std::vector<ObservedObject>& seen : FollowAll(12, seldom).seen) {
    for (const ObservedObject& one : seen) {
      if (!one.tracked()) continue;
      ++tracked;
      const std::vector<FitInlier>& inliers = one.detection.fit.inliers;
      ASSERT_EQ(inliers.size(), one.features.size());
      ASSERT_GT(inliers.size(), 3);
      std::vector<double> off_px;
      for (const FitInlier& inlier : inliers) {
        const Keypoint& from = inlier.keypoint_in_template;
        const Keypoint& at = one.features.keypoints[inlier.scene_keypoint];
        off_px.push_back(
            (one.detection.fit.scene_from_template.Apply({from.x, from.y}) - Eigen::Vector2d(at.x, at.y)).norm());
      }
      std::ranges::sort(off_px);
      EXPECT_LT(off_px[off_px.size() / 2], 3) << "the pose moves with its points";
    }
  }
  EXPECT_GT(tracked, 10) << "most frames are not searched";
}

TEST_F(FollowerTest, TrackIdIsKept) {
  FollowOptions options;
  options.restart_interval_frames = 12;
  std::map<std::int64_t, std::pair<int, Box>> last;  // by track: frame and box
  int continued = 0;
  const Frames frames = FollowAll(6, options);
  for (int i = 0; i < kFrames; ++i) {
    std::set<std::int64_t> here;
    for (const ObservedObject& seen : frames.seen[i]) {
      if (!seen.track) continue;
      EXPECT_TRUE(here.insert(*seen.track).second) << "one sighting of a track in a frame";
      const auto before = last.find(*seen.track);
      if (before != last.end()) {
        ++continued;
        EXPECT_EQ(before->second.first / 12, i / 12) << "tracks restart";
        if (before->second.first == i - 1) {
          EXPECT_GT(IntersectionOverUnion(before->second.second, seen.detection.box), 0);
        }
      }
      last[*seen.track] = {i, seen.detection.box};
    }
  }
  EXPECT_GT(continued, 20);
}

// Two objects of one model that pass each other: the detection further from a track does not take it.
TEST_F(FollowerTest, DetectionsTakeTracksByOverlap) {
  cv::Mat grey;
  cv::cvtColor(flight_.flight().Render(0).image, grey, cv::COLOR_BGR2GRAY);
  const FeatureSet features = extractor_->Extract(grey).value();
  std::vector<Detection> detections = recognizer_.Recognize(features).value();
  ASSERT_FALSE(detections.empty());
  detections.resize(1);
  Follower follower = Follower::Create(recognizer_, *extractor_, {}).value();
  const auto follow = [&](std::int64_t index) {
    return follower.Follow({.index = index, .time_s = 0, .image = grey}, FullFrameResult{features, detections}, {})
        .value();
  };
  const std::optional<std::int64_t> track = follow(0).at(0).track;
  ASSERT_TRUE(track);
  Detection passing = detections[0];
  const double shift_px = 3.0 / 7 * passing.box.width;  // an overlap of 0.4
  passing.box.x += shift_px;
  for (Eigen::Vector2d& corner : passing.outline) corner.x() += shift_px;
  detections.insert(detections.begin(), passing);
  const std::vector<ObservedObject> seen = follow(1);
  EXPECT_NE(seen.at(0).track, track);
  EXPECT_EQ(seen.at(1).track, track);
}

// After a restart frame, earlier frames have no influence.
TEST_F(FollowerTest, RestartDiscardsEarlierState) {
  FollowOptions options;
  options.restart_interval_frames = 12;
  const Frames all = FollowAll(6, options);
  Follower late = Follower::Create(recognizer_, *extractor_, options).value();
  for (int i = 12; i < kFrames; ++i) {
    cv::Mat grey;
    cv::cvtColor(flight_.flight().Render(i).image, grey, cv::COLOR_BGR2GRAY);
    const FeatureSet features = extractor_->Extract(grey).value();
    const std::vector<Detection> detections = recognizer_.Recognize(features).value();
    std::optional<FullFrameResult> whole;
    if (i % 6 == 0) whole.emplace(features, detections);
    const auto seen = late.Follow({.index = i, .time_s = 0.1 * i, .image = grey}, whole, {}).value();
    ASSERT_EQ(seen.size(), all.seen[i].size()) << "frame " << i;
    for (std::size_t k = 0; k < seen.size(); ++k) {
      EXPECT_EQ(seen[k].detection.box, all.seen[i][k].detection.box);
      EXPECT_EQ(seen[k].tracked(), all.seen[i][k].tracked());
      EXPECT_EQ(seen[k].track, all.seen[i][k].track) << "a resumed index gives the same";
    }
  }
}

}  // namespace
}  // namespace victorious

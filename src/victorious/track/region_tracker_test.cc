#include "victorious/track/region_tracker.h"

#include <cmath>
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "testing/drawn_objects.h"
#include "testing/drawn_town.h"

namespace victorious {
namespace {

using ::testing::SizeIs;

constexpr double kFrameInterval_s = 0.1;

// In OpenCV the origin is the first pixel's centre, here the first pixel's corner.
cv::Matx23d CvMap(const Similarity2& map) {
  const Eigen::Matrix2d linear = map.Linear();
  const Eigen::Vector2d offset = map.Apply({0.5, 0.5}) - Eigen::Vector2d(0.5, 0.5);
  return {linear(0, 0), linear(0, 1), offset.x(), linear(1, 0), linear(1, 1), offset.y()};
}

// A crate on the streets of a town, in frames of 400 x 300 px; both may move.
class World {
 public:
  explicit World(testing::ObjectKind kind = testing::ObjectKind::kCrate)
      : town_(testing::DrawTown({1000, 800}, 5)), object_(testing::DrawObject(kind, 2)) {}

  // `ground_px` is the position in the town's image of the frame's top left corner.
  [[nodiscard]] cv::Mat Draw(const Similarity2& frame_from_object,
                             const Eigen::Vector2d& ground_px = {200, 200}) const {
    const cv::Rect view(static_cast<int>(ground_px.x()), static_cast<int>(ground_px.y()), 400, 300);
    cv::Mat frame = town_(view).clone();
    cv::Mat laid;
    cv::warpAffine(object_.image, laid, CvMap(frame_from_object), frame.size(), cv::INTER_AREA);
    for (int y = 0; y < frame.rows; ++y) {
      for (int x = 0; x < frame.cols; ++x) {
        const cv::Vec4b above = laid.at<cv::Vec4b>(y, x);
        cv::Vec3b& below = frame.at<cv::Vec3b>(y, x);
        for (int c = 0; c < 3; ++c)
          below[c] = static_cast<uchar>((above[c] * above[3] + below[c] * (255 - above[3])) / 255);
      }
    }
    return frame;
  }

  [[nodiscard]] Polygon Outline(const Similarity2& frame_from_object) const {
    Polygon outline = object_.outline;
    for (Eigen::Vector2d& corner : outline) corner = frame_from_object.Apply(corner);
    return outline;
  }

 private:
  cv::Mat town_;
  testing::SyntheticObject object_;
};

std::vector<TrackPoint> PointsIn(const cv::Mat& frame, const Polygon& outline, int max_points = 60) {
  cv::Mat grey;
  cv::cvtColor(frame, grey, cv::COLOR_BGR2GRAY);
  std::vector<TrackPoint> points;
  for (const Eigen::Vector2d& position_px : DetectCorners(grey, outline, max_points)) {
    points.push_back({position_px, static_cast<std::uint32_t>(points.size())});
  }
  return points;
}

Similarity2 At(double x, double y, double scale = 0.5, double rotation_rad = 0) {
  return {scale, rotation_rad, {x, y}};
}

// Tracks one object.
class TestFollower {
 public:
  explicit TestFollower(const TrackOptions& options = {}) : tracker_(RegionTracker::Create(options).value()) {}

  TrackStep Start(const cv::Mat& frame, const Polygon& outline) {
    tracker_.Step({0, 0.0, frame});
    return tracker_.Start(outline, PointsIn(frame, outline));
  }

  // The step; std::nullopt once the track is removed.
  std::optional<TrackStep> Step(const cv::Mat& frame) {
    ++index_;
    const auto steps = tracker_.Step({index_, kFrameInterval_s * static_cast<double>(index_), frame});
    return steps.empty() ? std::nullopt : std::optional(steps.front());
  }

  RegionTracker& tracker() { return tracker_; }

 private:
  RegionTracker tracker_;
  std::int64_t index_ = 0;
};

TEST(RegionTracker, FollowsAnObjectOverMovingBackground) {
  const World world;
  TestFollower follower;
  // The outline has a margin of ground, which does not move with the object.
  Box user_box = BoundingBox(world.Outline(At(60, 80)));
  user_box = {user_box.x - 4, user_box.y - 4, user_box.width + 8, user_box.height + 8};
  follower.Start(world.Draw(At(60, 80)), BoxCorners(user_box));
  for (int i = 1; i <= 30; ++i) {
    const Similarity2 from_object = At(60 + 6 * i, 80 + 2 * i);
    const auto step = follower.Step(world.Draw(from_object, {200.0 + 5 * i, 200.0 - 3 * i}));
    ASSERT_TRUE(step && step->seen()) << i;
    EXPECT_GT(IntersectionOverUnion(step->box, BoundingBox(world.Outline(from_object))), 0.8) << i;
    EXPECT_GT(step->support, 0.3) << i;
  }
}

TEST(RegionTracker, FollowsRotationAndScale) {
  const World world;
  TestFollower follower;
  const auto from_object = [](int i) { return Similarity2{0.5 + 0.008 * i, 0.02 * i, {140, 90}}; };
  follower.Start(world.Draw(from_object(0)), world.Outline(from_object(0)));
  for (int i = 1; i <= 30; ++i) {
    const auto step = follower.Step(world.Draw(from_object(i)));
    ASSERT_TRUE(step && step->seen()) << i;
    EXPECT_GT(IntersectionOverUnion(step->outline, world.Outline(from_object(i))), 0.9) << i;
    EXPECT_NEAR(step->now_from_template.rotation_rad, 0.02 * i, 0.02) << i;
  }
}

TEST(RegionTracker, PointsKeepTheIndexOfTheirInlier) {
  const World world;
  TestFollower follower;
  const TrackStep first = follower.Start(world.Draw(At(60, 80)), world.Outline(At(60, 80)));
  const auto step = follower.Step(world.Draw(At(69, 78)));
  ASSERT_TRUE(step && step->seen());
  for (const TrackPoint& point : step->points) {
    ASSERT_TRUE(point.inlier);
    const auto origin = std::ranges::find(first.points, point.inlier, &TrackPoint::inlier);
    ASSERT_NE(origin, first.points.end());
    EXPECT_LT((point.position_px - origin->position_px - Eigen::Vector2d(9, -2)).norm(), 1.5);
  }
}

TEST(RegionTracker, ReportsOcclusionWithoutABox) {
  const World world;
  TestFollower follower({.missed_frames = 3});
  follower.Start(world.Draw(At(150, 100)), world.Outline(At(150, 100)));
  const Box object = BoundingBox(world.Outline(At(150, 100)));
  std::optional<TrackStep> step;
  for (int i = 1; i <= 14; ++i) {
    cv::Mat frame = world.Draw(At(150, 100));
    // A textured bus drives over the object and stays there.
    const int front = std::min(60 + 15 * i, 290);
    const cv::Mat bus = testing::DrawTown({160, 140}, 77);
    const cv::Rect area(std::max(0, front - 160), 80, std::min(front, 160), 140);
    bus(cv::Rect(0, 0, area.width, area.height)).copyTo(frame(area));
    step = follower.Step(frame);
    ASSERT_TRUE(step) << i;
    if (step->seen()) {
      EXPECT_GT(IntersectionOverUnion(step->box, object), 0.8) << i;
    }
    if (step->state == TrackState::kInactive) break;
  }
  EXPECT_EQ(step->state, TrackState::kInactive);
  EXPECT_EQ(step->loss, TrackLoss::kOccluded);
  EXPECT_TRUE(step->box.IsEmpty());
  EXPECT_FALSE(follower.Step(world.Draw(At(150, 100)))) << "an inactive track is removed";
}

TEST(RegionTracker, ReportsLeavingTheFrame) {
  const World world;
  TestFollower follower;
  follower.Start(world.Draw(At(260, 100)), world.Outline(At(260, 100)));
  std::optional<TrackStep> step;
  for (int i = 1; i <= 30; ++i) {
    step = follower.Step(world.Draw(At(260 + 8 * i, 100)));
    ASSERT_TRUE(step);
    EXPECT_LE(step->box.x + step->box.width, 400);
    if (step->state == TrackState::kInactive) break;
  }
  EXPECT_EQ(step->state, TrackState::kInactive);
  EXPECT_EQ(step->loss, TrackLoss::kLeftFrame);
}

TEST(RegionTracker, SurvivesFlickerWithoutABox) {
  const World world;
  TestFollower follower;
  follower.Start(world.Draw(At(60, 80)), world.Outline(At(60, 80)));
  for (int i = 1; i <= 20; ++i) {
    cv::Mat frame = world.Draw(At(60 + 7 * i, 80));
    const bool blank = i % 5 == 4;
    if (blank) frame.setTo(cv::Scalar::all(12));
    if (i % 5 == 2) frame = frame * 0.5;
    const auto step = follower.Step(frame);
    ASSERT_TRUE(step) << i;
    EXPECT_EQ(step->state, TrackState::kActive) << i;
    EXPECT_EQ(step->seen(), !blank) << i;
    EXPECT_EQ(step->box.IsEmpty(), blank) << i;
    if (!blank) {
      EXPECT_GT(IntersectionOverUnion(step->box, BoundingBox(world.Outline(At(60 + 7 * i, 80)))), 0.9) << i;
    }
  }
}

TEST(RegionTracker, PredictionReacquiresAfterALargeMotion) {
  const World world;
  for (const bool predict : {true, false}) {
    TrackOptions options;
    options.predict_motion = predict;
    options.flow.pyramid_levels = 2;
    TestFollower follower(options);
    follower.Start(world.Draw(At(20, 80)), world.Outline(At(20, 80)));
    for (int i = 1; i <= 5; ++i) follower.Step(world.Draw(At(20 + 8 * i, 80)));
    for (int i = 6; i <= 9; ++i) follower.Step(cv::Mat(300, 400, CV_8UC3, cv::Scalar::all(0)));
    const auto step = follower.Step(world.Draw(At(20 + 8 * 10, 80)));
    ASSERT_TRUE(step);
    EXPECT_EQ(step->seen(), predict);
  }
}

TEST(RegionTracker, NewTrackIsSearchedAtPredictedAndOldPosition) {
  const World world;
  const Similarity2 before = At(200, 80);
  const Similarity2 moved = At(120, 80);
  for (const bool predict : {true, false}) {
    TrackOptions options;
    options.predict_motion = predict;
    options.flow.pyramid_levels = 2;
    TestFollower passing(options);
    passing.Start(world.Draw(before), world.Outline(before));
    const auto step = passing.Step(world.Draw(moved, {280, 200}));
    ASSERT_TRUE(step);
    EXPECT_EQ(step->seen(), predict) << "the object is static on ground that moves by 80 px per frame";
    if (predict) {
      EXPECT_GT(IntersectionOverUnion(step->box, BoundingBox(world.Outline(moved))), 0.9);
    }
    TestFollower kept_in_view(options);
    kept_in_view.Start(world.Draw(before), world.Outline(before));
    const auto still = kept_in_view.Step(world.Draw(before, {280, 200}));
    EXPECT_TRUE(still && still->seen()) << "the camera follows the object over the ground";
  }
}

TEST(RegionTracker, BecomesInactiveUnlessConfirmed) {
  const World world;
  TestFollower follower({.unconfirmed_frames = 4});
  const cv::Mat frame = world.Draw(At(60, 80));
  const Polygon outline = world.Outline(At(60, 80));
  const TrackStep first = follower.Start(frame, outline);
  for (int i = 1; i <= 4; ++i) EXPECT_EQ(follower.Step(frame)->state, TrackState::kActive);
  const TrackStep confirmed = follower.tracker().Confirm(first.track, outline, PointsIn(frame, outline));
  EXPECT_EQ(confirmed.track, first.track);
  EXPECT_EQ(confirmed.unconfirmed_frames, 0);
  for (int i = 1; i <= 4; ++i) EXPECT_EQ(follower.Step(frame)->state, TrackState::kActive);
  const auto last = follower.Step(frame);
  EXPECT_EQ(last->state, TrackState::kInactive);
  EXPECT_EQ(last->loss, TrackLoss::kUnconfirmed);
}

TEST(RegionTracker, SearchRegionIsTheDilatedBoxInsideTheFrame) {
  const World world;
  TestFollower follower({.dilation_factor = 2});
  const Box box = BoundingBox(world.Outline(At(150, 100)));
  const TrackStep step = follower.Start(world.Draw(At(150, 100)), world.Outline(At(150, 100)));
  EXPECT_NEAR(step.search_box.width, 2 * box.width, 1e-9);
  EXPECT_NEAR(step.search_box.x + step.search_box.width / 2, box.x + box.width / 2, 1e-9);
  const TrackStep corner = follower.tracker().Start(BoxCorners({0, 0, 50, 50}),
                                                    PointsIn(world.Draw(At(150, 100)), BoxCorners({0, 0, 50, 50})));
  EXPECT_EQ(corner.search_box, (Box{0, 0, 75, 75}));
}

TEST(RegionTracker, TooFewPointsStartNoTrack) {
  TestFollower follower;
  const TrackStep step =
      follower.Start(cv::Mat(300, 400, CV_8UC3, cv::Scalar::all(90)), BoxCorners({50, 50, 100, 100}));
  EXPECT_EQ(step.state, TrackState::kInactive);
  EXPECT_EQ(step.loss, TrackLoss::kLostPoints);
  EXPECT_FALSE(follower.Step(cv::Mat(300, 400, CV_8UC3, cv::Scalar::all(90))));
}

TEST(RegionTracker, FollowsSeveralTracksAndDropsStoppedOnes) {
  const World world;
  RegionTracker tracker = RegionTracker::Create({}).value();
  const cv::Mat frame = world.Draw(At(150, 100));
  tracker.Step({0, 0, frame});
  const Polygon object = world.Outline(At(150, 100));
  const Polygon ground = BoxCorners({20, 20, 80, 60});
  const TrackStep first = tracker.Start(object, PointsIn(frame, object));
  const TrackStep second = tracker.Start(ground, PointsIn(frame, ground));
  const auto steps = tracker.Step({1, 0.1, world.Draw(At(156, 100), {204, 200})});
  ASSERT_THAT(steps, SizeIs(2));
  EXPECT_NEAR(steps[0].now_from_template.translation.x(), 6, 0.5);
  EXPECT_NEAR(steps[1].now_from_template.translation.x(), -4, 0.5);
  tracker.Stop(first.track);
  const auto rest = tracker.Step({2, 0.2, world.Draw(At(156, 100), {204, 200})});
  ASSERT_THAT(rest, SizeIs(1));
  EXPECT_EQ(rest[0].track, second.track);
}

TEST(RegionTracker, FrameOfAnotherSizeLosesOnlyThePoints) {
  const World world;
  TestFollower follower;
  follower.Start(world.Draw(At(60, 80)), world.Outline(At(60, 80)));
  const auto step = follower.Step(cv::Mat(150, 200, CV_8UC1, cv::Scalar(40)));
  ASSERT_TRUE(step);
  EXPECT_FALSE(step->seen());
}

TEST(RegionTracker, RefusesOptionsOutOfRange) {
  EXPECT_EQ(RegionTracker::Create({.dilation_factor = 0.5}).error().code, ErrorCode::kInvalidArgument);
}

// An image of another town covers the object from one frame to the next.
TEST(RegionTracker, MissedFramesIsTheNumberOfFramesWithoutABoxThatATrackSurvives) {
  const World world;
  const cv::Mat cover = testing::DrawTown({160, 140}, 77);
  const auto frames_until_inactive = [&](int missed_frames) {
    TestFollower follower({.missed_frames = missed_frames});
    follower.Start(world.Draw(At(150, 100)), world.Outline(At(150, 100)));
    cv::Mat covered = world.Draw(At(150, 100));
    cover.copyTo(covered(cv::Rect(100, 60, cover.cols, cover.rows)));
    for (int i = 1; i <= 20; ++i) {
      const std::optional<TrackStep> step = follower.Step(covered);
      if (!step || step->state == TrackState::kInactive) return i;
      EXPECT_FALSE(step->seen()) << i;
    }
    return 0;
  };
  EXPECT_EQ(frames_until_inactive(0), 1);
  EXPECT_EQ(frames_until_inactive(4), 5);
}

}  // namespace
}  // namespace victorious

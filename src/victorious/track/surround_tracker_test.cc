#include "victorious/track/surround_tracker.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "testing/drawn_town.h"

namespace victorious {
namespace {

// A plain red roof in a town, from a camera that turns and approaches.
class RoofInTown {
 public:
  explicit RoofInTown(const cv::Scalar& colour = {40, 40, 180}) : town_(testing::DrawTown({900, 900}, 6)) {
    if (colour[2] >= 0) cv::rectangle(town_, kRoof, colour, cv::FILLED);
  }

  [[nodiscard]] cv::Mat Draw(double turn_deg, double scale) const {
    cv::Mat frame;
    cv::warpAffine(town_, frame, Map(turn_deg, scale), {360, 240});
    return frame;
  }

  [[nodiscard]] static Polygon Outline(double turn_deg, double scale) {
    const cv::Matx23d map = Map(turn_deg, scale);
    Polygon outline = BoxCorners({static_cast<double>(kRoof.x), static_cast<double>(kRoof.y),
                                  static_cast<double>(kRoof.width), static_cast<double>(kRoof.height)});
    for (Eigen::Vector2d& point : outline) {
      const cv::Vec2d moved = map * cv::Vec3d(point.x(), point.y(), 1);
      point = {moved[0], moved[1]};
    }
    return outline;
  }

 private:
  static inline const cv::Rect kRoof{410, 430, 80, 40};

  static cv::Matx23d Map(double turn_deg, double scale) {
    cv::Mat map = cv::getRotationMatrix2D({450, 450}, turn_deg, scale);
    map.at<double>(0, 2) += 180 - 450;
    map.at<double>(1, 2) += 120 - 450;
    return map;
  }

  cv::Mat town_;
};

TEST(SurroundTracker, HoldsAPlainObjectThroughATurnOfTheCamera) {
  const RoofInTown scene;
  SurroundTracker tracker(SurroundFrame(scene.Draw(0, 1)), RoofInTown::Outline(0, 1));
  ASSERT_TRUE(tracker.first());
  EXPECT_EQ(tracker.first()->contrast, 1);
  for (int i = 1; i <= 60; ++i) {
    const double scale = 1 + 0.005 * i;
    const auto step = tracker.Step(SurroundFrame(scene.Draw(3 * i, scale)));
    ASSERT_TRUE(step) << i;
    EXPECT_GT(IntersectionOverUnion(step->place, RoofInTown::Outline(3 * i, scale)), 0.8) << i;
    // Of a flat rectangle that has turned by 45 degrees, the box of the inscribed ellipse is half the bounding box.
    const Box truth = BoundingBox(RoofInTown::Outline(3 * i, scale));
    EXPECT_GT(IntersectionOverUnion(step->box, truth), 0.42) << i;
    EXPECT_NEAR(step->box.x + step->box.width / 2, truth.x + truth.width / 2, 0.15 * truth.width) << i;
    EXPECT_NEAR(step->box.y + step->box.height / 2, truth.y + truth.height / 2, 0.15 * truth.height) << i;
    EXPECT_GT(step->contrast, 0.7) << i;
  }
}

TEST(SurroundTracker, ContrastFallsOnceTheObjectHasGone) {
  const RoofInTown with;
  const RoofInTown without({-1, -1, -1});
  SurroundTracker tracker(SurroundFrame(with.Draw(0, 1)), RoofInTown::Outline(0, 1));
  ASSERT_TRUE(tracker.Step(SurroundFrame(with.Draw(2, 1))));
  const auto step = tracker.Step(SurroundFrame(without.Draw(4, 1)));
  ASSERT_TRUE(step) << "its surroundings are there";
  EXPECT_LT(step->contrast, 0.4);
}

TEST(SurroundTracker, ACutEndsTheTrack) {
  const RoofInTown scene;
  SurroundTracker tracker(SurroundFrame(scene.Draw(0, 1)), RoofInTown::Outline(0, 1));
  cv::Mat other;
  cv::warpAffine(testing::DrawTown({900, 900}, 77), other, cv::getRotationMatrix2D({450, 450}, 30, 1), {360, 240});
  EXPECT_FALSE(tracker.Step(SurroundFrame(other)));
}

TEST(SurroundTracker, LosesAnObjectThatLeavesTheFrame) {
  const RoofInTown scene;
  const cv::Mat frame = scene.Draw(0, 1);
  SurroundTracker tracker(SurroundFrame(frame), RoofInTown::Outline(0, 1));
  int steps = 0;
  for (; steps < 40; ++steps) {
    cv::Mat moved;
    cv::warpAffine(frame, moved, cv::Matx23d(1, 0, 8.0 * (steps + 1), 0, 1, 0), frame.size(), cv::INTER_LINEAR,
                   cv::BORDER_REFLECT);
    if (!tracker.Step(SurroundFrame(moved))) break;
  }
  EXPECT_GT(steps, 12);
  EXPECT_LT(steps, 30);
}

TEST(SurroundTracker, AnEmptyOutlineIsNotFollowed) {
  const RoofInTown scene;
  SurroundTracker tracker(SurroundFrame(scene.Draw(0, 1)), {});
  EXPECT_FALSE(tracker.first());
  EXPECT_FALSE(tracker.Step(SurroundFrame(scene.Draw(0, 1))));
}

}  // namespace
}  // namespace victorious

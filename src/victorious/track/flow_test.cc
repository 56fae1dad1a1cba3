#include "victorious/track/flow.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "testing/drawn_town.h"
#include "victorious/geometry/similarity.h"
#include "victorious/track/patch.h"

namespace victorious {
namespace {

cv::Mat GreyTown() {
  cv::Mat grey;
  cv::cvtColor(testing::DrawTown({480, 360}, 3), grey, cv::COLOR_BGR2GRAY);
  return grey;
}

const Polygon kMiddle = BoxCorners({100, 80, 200, 160});

TEST(DetectCorners, AreInsideTheOutlineAndSpread) {
  const std::vector<Eigen::Vector2d> points = DetectCorners(GreyTown(), kMiddle, 50);
  ASSERT_GT(points.size(), 30U);
  for (const Eigen::Vector2d& point : points) EXPECT_TRUE(BoundingBox(kMiddle).Contains(point.x(), point.y()));
  EXPECT_GT(std::abs(SignedArea(ConvexHull(points))), 0.5 * BoundingBox(kMiddle).Area());
}

TEST(DetectCorners, NoneInUniformImageOrOutside) {
  EXPECT_TRUE(DetectCorners(cv::Mat(100, 100, CV_8UC1, cv::Scalar(90)), BoxCorners({10, 10, 50, 50}), 20).empty());
  EXPECT_TRUE(DetectCorners(GreyTown(), BoxCorners({-90, -90, 50, 50}), 20).empty());
}

TEST(TrackPointsForwardBackward, RecoversSubPixelShift) {
  const cv::Mat before = GreyTown();
  cv::Mat after;
  const cv::Matx23d shift(1, 0, 7.4, 0, 1, -5.2);
  cv::warpAffine(before, after, shift, before.size(), cv::INTER_CUBIC, cv::BORDER_REFLECT);
  const std::vector<Eigen::Vector2d> points = DetectCorners(before, kMiddle, 50);
  const auto followed = TrackPointsForwardBackward(FlowPyramid(before), FlowPyramid(after), points, points);
  int right = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (followed[i] && (*followed[i] - points[i] - Eigen::Vector2d(7.4, -5.2)).norm() < 0.1) ++right;
  }
  EXPECT_GE(right, 0.95 * static_cast<double>(points.size()));
}

TEST(TrackPointsForwardBackward, FailsForBlankFramesAndFramesOfAnotherSize) {
  const cv::Mat before = GreyTown();
  const std::vector<Eigen::Vector2d> points = DetectCorners(before, kMiddle, 50);
  for (const cv::Size size : {before.size(), cv::Size(100, 100)}) {
    const cv::Mat blank(size, CV_8UC1, cv::Scalar(70));
    for (const auto& position : TrackPointsForwardBackward(FlowPyramid(before), FlowPyramid(blank), points, points)) {
      EXPECT_FALSE(position);
    }
  }
}

// Sums of doubles round beyond the border for some of these.
TEST(DetectCorners, OutlinesMayEndAtOrBeyondTheBorder) {
  const cv::Mat town = GreyTown();
  for (int i = 0; i < 100; ++i) {
    const double from = 0.37 * (i - 70) - 0.1;
    for (const Eigen::Vector2d& corner :
         DetectCorners(town, BoxCorners({from, from, 2.0 * town.cols, 2.0 * town.rows}), 20)) {
      EXPECT_GE(corner.minCoeff(), from - 1);
      EXPECT_LT(corner.x(), town.cols);
      EXPECT_LT(corner.y(), town.rows);
    }
  }
}

TEST(Patch, IsInvariantToBrightnessRotationAndScale) {
  const cv::Mat before = GreyTown();
  const Eigen::Vector2d position(200.5, 150.5);
  const Patch patch(before, position, 13, Eigen::Matrix2d::Identity());
  EXPECT_NEAR(patch.NccScore(Patch(before * 0.5 + 40, position, 13, Eigen::Matrix2d::Identity())), 1, 0.02);

  const Similarity2 turn{1.3, 0.5, {20, -30}};
  const Eigen::Matrix3d matrix = turn.Matrix();
  // In OpenCV the origin is the first pixel's centre.
  const Eigen::Vector2d offset = turn.Apply({0.5, 0.5}) - Eigen::Vector2d(0.5, 0.5);
  const cv::Matx23d affine(matrix(0, 0), matrix(0, 1), offset.x(), matrix(1, 0), matrix(1, 1), offset.y());
  cv::Mat after;
  cv::warpAffine(before, after, affine, before.size(), cv::INTER_CUBIC, cv::BORDER_REFLECT);
  EXPECT_GT(patch.NccScore(Patch(after, turn.Apply(position), 13, turn.Linear())), 0.97);
  EXPECT_LT(patch.NccScore(Patch(after, turn.Apply(position) + Eigen::Vector2d(15, 0), 13, turn.Linear())), 0.5);
}

TEST(Patch, UniformPatchHasZeroNccScore) {
  const cv::Mat flat(50, 50, CV_8UC1, cv::Scalar(99));
  const Patch patch(flat, {25, 25}, 9, Eigen::Matrix2d::Identity());
  EXPECT_TRUE(patch.IsFlat());
  EXPECT_EQ(patch.NccScore(patch), 0);
}

}  // namespace
}  // namespace victorious

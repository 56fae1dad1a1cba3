#include "victorious/lab/evaluate/warped_view.h"

#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "testing/small_cad_model.h"
#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

ViewDirection FromDegrees(double azimuth_deg, double off_nadir_deg) {
  return {RadiansFromDegrees(azimuth_deg), RadiansFromDegrees(off_nadir_deg)};
}

double MeanDifference(const WarpedView& a, const WarpedView& b) {
  cv::Mat off;
  cv::absdiff(a.grey, b.grey, off);
  return cv::mean(off, a.mask & b.mask)[0];
}

double SharedMask(const WarpedView& a, const WarpedView& b) {
  return static_cast<double>(cv::countNonZero(a.mask & b.mask)) / cv::countNonZero(a.mask | b.mask);
}

// A direction between two views renders alike from both of them, although the views themselves differ.
TEST(WarpedView, BothNeighboursWarpToTheSameImage) {
  const ObjectModel& model = testing::SmallCadModel();
  const WarpedView left = WarpView(model, FromDegrees(44.9, 40), {}).value();   // from azimuth 30
  const WarpedView right = WarpView(model, FromDegrees(45.1, 40), {}).value();  // from azimuth 60
  const WarpedView before = WarpView(model, FromDegrees(30, 30), {}).value();
  const WarpedView after = WarpView(model, FromDegrees(60, 30), {}).value();
  EXPECT_GT(SharedMask(left, right), 0.93);
  EXPECT_GT(SharedMask(left, right), SharedMask(before, after) + 0.02);
  EXPECT_LT(MeanDifference(left, right), 0.75 * MeanDifference(before, after));
}

// Holds for small rotations, as between views; larger rotations leave occluded surfaces missing.
TEST(WarpedView, HasNoGaps) {
  const WarpedView view = WarpView(testing::SmallCadModel(), FromDegrees(0, 4), {}).value();
  const cv::Rect middle(view.mask.cols / 2 - 20, view.mask.rows / 2 - 20, 40, 40);
  EXPECT_EQ(cv::countNonZero(view.mask(middle)), middle.area());
  EXPECT_EQ(view.mask.at<std::uint8_t>(0, 0), 0);
}

TEST(WarpedView, IsRelitByTheSun) {
  const ViewDirection direction = FromDegrees(100, 45);
  const WarpedView soft = WarpView(testing::SmallCadModel(), direction, {}).value();
  const WarpedView east = WarpView(testing::SmallCadModel(), direction, FromDegrees(90, 50)).value();
  const WarpedView west = WarpView(testing::SmallCadModel(), direction, FromDegrees(270, 50)).value();
  EXPECT_EQ(SharedMask(soft, east), 1);
  EXPECT_GT(MeanDifference(soft, east), 3);
  EXPECT_GT(MeanDifference(east, west), 3);
}

TEST(WarpedView, DamagedSurfaceIsAnError) {
  ObjectModel model = testing::SmallCadModel();
  for (ModelView& view : model.views) view.surface = view.surface.first(50);
  const auto result = WarpView(model, FromDegrees(0, 0), {});
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::kDataLoss);
}

}  // namespace
}  // namespace victorious

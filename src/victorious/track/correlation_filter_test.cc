#include "victorious/track/correlation_filter.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "testing/drawn_town.h"
#include "victorious/track/cell_features.h"
#include "victorious/track/cut_out.h"
#include "victorious/track/scale_filter.h"

namespace victorious {
namespace {

constexpr int kCells = 48;
constexpr double kWindow_px = kCells * kCell_px;

cv::Mat Town() { return testing::DrawTown({600, 500}, 4); }

CellFeatures WindowAt(const cv::Mat& town, double x, double y) {
  return ComputeHogCells(
      CropRotated(ImagePyramid(town), {{x, y}, kWindow_px, kWindow_px, 0}, {kCells * kCell_px, kCells * kCell_px}));
}

TEST(ComputeHogCells, DependOnGradientDirectionNotBrightness) {
  cv::Mat upright(40, 40, CV_8UC1, cv::Scalar(60));
  upright(cv::Rect(20, 0, 20, 40)) = 180;  // dark to bright along +x: direction 0
  const CellFeatures cells = ComputeHogCells(upright);
  ASSERT_EQ(cells.size(), static_cast<std::size_t>(kGradientChannels));
  EXPECT_EQ(cells[0].size(), cv::Size(10, 10));
  EXPECT_GT(cells[0].at<float>(5, 5), 0.3F);
  EXPECT_NEAR(cells[4].at<float>(5, 5), 0, 0.02);  // downward
  EXPECT_NEAR(cells[9].at<float>(5, 5), 0, 0.02);  // backward
  EXPECT_NEAR(cells[0].at<float>(5, 1), 0, 0.02);  // no gradient
  const CellFeatures dimmer = ComputeHogCells(upright * 0.5);
  EXPECT_NEAR(dimmer[0].at<float>(5, 5), cells[0].at<float>(5, 5), 0.02);
}

TEST(ComputeColourCells, SumToOneAndSeparateRedFromGreen) {
  const cv::Mat red(8, 8, CV_8UC3, cv::Scalar(20, 20, 220));
  const cv::Mat green(8, 8, CV_8UC3, cv::Scalar(20, 220, 20));
  for (const cv::Mat& image :
       {red, green, cv::Mat(8, 8, CV_8UC3, cv::Scalar::all(77)), cv::Mat(Town()(cv::Rect(0, 0, 8, 8)))}) {
    double sum = 0;
    for (const cv::Mat& channel : ComputeColourCells(image)) sum += channel.at<float>(1, 1);
    EXPECT_NEAR(sum, 1, 1e-5);
  }
  double common = 0;
  for (int k = 0; k < kColourChannels; ++k) {
    common += ComputeColourCells(red)[static_cast<std::size_t>(k)].at<float>(0, 0) *
              ComputeColourCells(green)[static_cast<std::size_t>(k)].at<float>(0, 0);
  }
  EXPECT_LT(common, 0.05);
}

TEST(CellFeatures, AcceptsImagesSmallerThanACell) {
  EXPECT_TRUE(ComputeHogCells(cv::Mat(3, 3, CV_8UC3, cv::Scalar::all(5))).front().empty());
  EXPECT_TRUE(ComputeColourCells(cv::Mat(3, 3, CV_8UC1, cv::Scalar(5))).front().empty());
}

TEST(CropRotated, IsUprightForAnyRotation) {
  const cv::Mat town = Town();
  const cv::Mat upright = CropRotated(ImagePyramid(town), {{300, 250}, 80, 60, 0}, {80, 60});
  EXPECT_EQ(cv::norm(upright, town(cv::Rect(260, 220, 80, 60)), cv::NORM_INF), 0);
  // The town rotated by 90 degrees about the same point, +x towards +y.
  cv::Mat turned;
  const cv::Matx23d quarter(0, -1, 300 + 250 - 1.0, 1, 0, 250 - 300.0);
  cv::warpAffine(town, turned, quarter, town.size());
  const cv::Mat again = CropRotated(ImagePyramid(turned), {{300, 250}, 80, 60, CV_PI / 2}, {80, 60});
  EXPECT_LT(cv::norm(upright, again, cv::NORM_L1) / static_cast<double>(upright.total() * 3), 1);
}

TEST(CropRotated, ReplicatesTheImageBorder) {
  const cv::Mat grey(50, 50, CV_8UC1, cv::Scalar(90));
  const cv::Mat cut = CropRotated(ImagePyramid(grey), {{-40, -40}, 60, 60, 0.4}, {20, 20});
  EXPECT_EQ(cv::norm(cut, cv::Mat(20, 20, CV_8UC1, cv::Scalar(90)), cv::NORM_INF), 0);
}

TEST(CorrelationFilter, LocatesTheShiftedObject) {
  const cv::Mat town = Town();
  CorrelationFilter filter({{kCells, kCells}, {10, 10}});
  filter.Update(WindowAt(town, 300, 250), 8);
  const FilterResponse same = filter.ComputeResponse(WindowAt(town, 300, 250));
  EXPECT_NEAR(same.peak.x, 0, 0.1);
  EXPECT_NEAR(same.peak.y, 0, 0.1);
  // The window moves to the left, so the object moves to the right in it.
  const FilterResponse moved = filter.ComputeResponse(WindowAt(town, 300 - 5 * kCell_px, 250 + 2 * kCell_px));
  EXPECT_NEAR(moved.peak.x, 5, 0.3);
  EXPECT_NEAR(moved.peak.y, -2, 0.3);
  EXPECT_GT(moved.sharpness, 15);
}

TEST(CorrelationFilter, ResponseIsFlatOffTheObject) {
  const cv::Mat town = Town();
  CorrelationFilter filter({{kCells, kCells}, {10, 10}});
  for (int i = 0; i < 3; ++i) filter.Update(WindowAt(town, 300, 250), 8);
  const double there = filter.ComputeResponse(WindowAt(town, 300, 250)).sharpness;
  const double elsewhere = filter.ComputeResponse(WindowAt(testing::DrawTown({600, 500}, 9), 300, 250)).sharpness;
  EXPECT_LT(elsewhere, 0.35 * there);
}

TEST(CorrelationFilter, CopyIsIndependent) {
  const cv::Mat town = Town();
  CorrelationFilter filter({{kCells, kCells}, {10, 10}});
  filter.Update(WindowAt(town, 300, 250), 8);
  const CorrelationFilter copy = filter;
  const double before = copy.ComputeResponse(WindowAt(town, 310, 250)).height;
  filter.Update(WindowAt(town, 200, 150), 0.1);
  EXPECT_EQ(copy.ComputeResponse(WindowAt(town, 310, 250)).height, before);
}

TEST(ScaleFilter, EstimatesScaleChange) {
  const cv::Mat town = Town();
  const RotatedBox box{{300, 250}, 90, 60, 0};
  ScaleFilter filter(box);
  filter.Update(ImagePyramid(town), box, 1);
  EXPECT_NEAR(filter.EstimateScaleChange(ImagePyramid(town), box), 1, 0.005);
  for (const double growth : {0.9, 0.95, 1.05, 1.1}) {
    cv::Mat grown;
    const cv::Matx23d map(growth, 0, 300 * (1 - growth) + 0.5 * (growth - 1), 0, growth,
                          250 * (1 - growth) + 0.5 * (growth - 1));
    cv::warpAffine(town, grown, map, town.size(), cv::INTER_CUBIC);
    EXPECT_NEAR(filter.EstimateScaleChange(ImagePyramid(grown), box), growth, 0.02) << growth;
  }
}

}  // namespace
}  // namespace victorious

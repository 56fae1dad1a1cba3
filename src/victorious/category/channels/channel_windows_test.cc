#include "victorious/category/channels/channel_windows.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <set>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace victorious {
namespace {

// Noise without symmetry, in colour.
cv::Mat Texture(int width, int height) {
  cv::Mat texture(height, width, CV_8UC3);
  cv::RNG(4).fill(texture, cv::RNG::UNIFORM, 0, 255);
  cv::GaussianBlur(texture, texture, {}, 2);
  cv::normalize(texture, texture, 0, 255, cv::NORM_MINMAX);
  return texture;
}

ChannelLevel FirstLevel(const cv::Mat& image, double min_cell_px) {
  ChannelLevel first;
  ForEachLevel(image, min_cell_px, [&](const ChannelLevel& level) {
    if (first.cell_width_px == 0) first = level;
  });
  return first;
}

double MeanDifference(const WindowFeatures& a, const WindowFeatures& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::abs(a[i] - b[i]);
  return sum / static_cast<double>(a.size());
}

TEST(ChannelWindows, ACopyOfAHeadingSeesTheTurnedImage) {
  const cv::Mat image = Texture(64, 64);
  constexpr int kMiddle = 12;  // of 40 cells with their border
  const WindowFeatures trained = FirstLevel(image, 2).Features(kMiddle, kMiddle, {});
  for (const HeadingCopy& copy : kHeadingCopies) {
    cv::Mat turned = image.clone();
    if (copy.is_transposed) cv::transpose(turned, turned);
    if (copy.is_mirrored) cv::flip(turned, turned, 1);
    const ChannelLevel level = FirstLevel(turned, 2);
    ASSERT_EQ(level.planes.columns, 40);
    const WindowFeatures seen = level.Features(kMiddle, kMiddle, copy);
    EXPECT_LT(MeanDifference(trained, seen), 0.1);
    if (copy.is_transposed || copy.is_mirrored) {
      EXPECT_GT(MeanDifference(trained, level.Features(kMiddle, kMiddle, {})), 10);
    }
  }
}

TEST(ChannelWindows, ACopyRenamesEveryFeatureOnce) {
  for (const HeadingCopy& copy : kHeadingCopies) {
    std::set<int> seen;
    for (int f = 0; f < kWindowFeatures; ++f) seen.insert(CopiedFeature(copy, f));
    EXPECT_EQ(seen.size(), static_cast<std::size_t>(kWindowFeatures));
    EXPECT_EQ(*seen.rbegin(), kWindowFeatures - 1);
  }
}

TEST(ChannelWindows, LevelsReachFromTheFinestCellsToTheWholeImage) {
  std::vector<double> cells;
  ForEachLevel(Texture(400, 300), 1.5, [&](const ChannelLevel& level) {
    cells.push_back(level.cell_width_px);
    const double middle_px = level.Middle(0, 0).x;
    EXPECT_NEAR(middle_px, (kWindowCells / 2.0 - kLevelBorder) * level.cell_width_px, 1e-9);
  });
  ASSERT_GT(cells.size(), 10U);
  EXPECT_NEAR(cells.front(), 1.5, 0.02);
  for (std::size_t i = 1; i < cells.size(); ++i) EXPECT_NEAR(cells[i] / cells[i - 1], std::cbrt(2.0), 0.07) << i;
  EXPECT_GT(cells.back() * kWindowCells, 300);
}

TEST(ChannelWindows, OffsetsIntoTheFinestLevelFitIn32Bits) {
  EXPECT_EQ(FinestCell({1920, 1080}, 0.5), 0.5);
  for (const cv::Size& image : {cv::Size(8192, 6144), cv::Size(16384, 16384), cv::Size(100000, 2000)}) {
    const double cell_px = FinestCell(image, 0.5);
    const double cells = (image.width / cell_px + 2 * kLevelBorder) * (image.height / cell_px + 2 * kLevelBorder);
    EXPECT_LT(cells * kChannelCount, std::numeric_limits<std::int32_t>::max()) << image;
  }
}

TEST(ChannelWindows, ACutWindowIsThatOfTheLevel) {
  const cv::Mat image = Texture(200, 160);
  const ChannelLevel level = FirstLevel(image, 2);
  const WindowFeatures of_level = level.Features(40, 30, {});
  const WindowCutter cutter(image);
  const WindowFeatures cut = cutter.Cut(level.Middle(40, 30), level.cell_width_px, 0, false);
  EXPECT_LT(MeanDifference(of_level, cut), 1);
  EXPECT_GT(MeanDifference(of_level, cutter.Cut(level.Middle(42, 30), level.cell_width_px, 0, false)), 5);
}

TEST(ChannelWindows, ACutWindowIsTurnedAndMirrored) {
  const cv::Mat image = Texture(120, 120);
  const WindowCutter cutter(image);
  const WindowFeatures upright = cutter.Cut({60, 60}, 2, 0, false);
  cv::Mat turned;
  cv::rotate(image, turned, cv::ROTATE_90_CLOCKWISE);  // x becomes y, as a turn by 90 degrees from x towards y
  EXPECT_LT(MeanDifference(WindowCutter(turned).Cut({60, 60}, 2, 0, false), cutter.Cut({60, 60}, 2, CV_PI / 2, false)),
            1);
  cv::Mat mirrored;
  cv::flip(image, mirrored, 0);
  EXPECT_LT(MeanDifference(WindowCutter(mirrored).Cut({60, 60}, 2, 0, false), cutter.Cut({60, 60}, 2, 0, true)), 1);
  EXPECT_GT(MeanDifference(upright, cutter.Cut({60, 60}, 2, CV_PI / 2, false)), 5);
}

}  // namespace
}  // namespace victorious

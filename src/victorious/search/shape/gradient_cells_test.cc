#include "victorious/search/shape/gradient_cells.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

cv::Mat Edge(double angle_rad, int inside, int outside) {
  cv::Mat grey(64, 64, CV_8U);
  for (int row = 0; row < 64; ++row) {
    for (int column = 0; column < 64; ++column) {
      const double across = (column - 31.5) * std::cos(angle_rad) + (row - 31.5) * std::sin(angle_rad);
      grey.at<std::uint8_t>(row, column) = static_cast<std::uint8_t>(across > 0 ? inside : outside);
    }
  }
  return grey;
}

int StrongestOrientation(const GradientCells& cells, int row, int column) {
  const std::uint8_t* const cell = cells.at(row, column);
  return static_cast<int>(std::max_element(cell, cell + kCellOrientations) - cell);
}

TEST(GradientCells, HaveACellAtEverySecondPixel) {
  const GradientCells cells = MakeGradientCells(cv::Mat::zeros(31, 50, CV_8U));
  EXPECT_EQ(cells.rows, 16);
  EXPECT_EQ(cells.columns, 25);
  EXPECT_EQ(cells.codes.size(), 16U * 25U * kCellOrientations);
}

TEST(GradientCells, OfAUniformImageAreZero) {
  const GradientCells cells = MakeGradientCells(cv::Mat(40, 40, CV_8U, cv::Scalar(77)));
  EXPECT_EQ(*std::ranges::max_element(cells.codes), 0);
}

TEST(GradientCells, ShowTheOrientationOfAnEdge) {
  EXPECT_EQ(StrongestOrientation(MakeGradientCells(Edge(0, 200, 50)), 16, 16), 0);
  EXPECT_EQ(StrongestOrientation(MakeGradientCells(Edge(kPi / 4, 200, 50)), 16, 16), 2);
  EXPECT_EQ(StrongestOrientation(MakeGradientCells(Edge(kPi / 2, 200, 50)), 16, 16), 4);
}

TEST(GradientCells, DoNotDependOnTheSignOfTheContrast) {
  const GradientCells light = MakeGradientCells(Edge(0.3, 180, 90));
  const GradientCells dark = MakeGradientCells(Edge(0.3, 90, 180));
  EXPECT_EQ(light.codes, dark.codes);
}

TEST(GradientCells, DependLittleOnTheContrast) {
  const GradientCells strong = MakeGradientCells(Edge(0, 220, 20));
  const GradientCells weak = MakeGradientCells(Edge(0, 130, 100));
  EXPECT_NEAR(strong.at(16, 16)[0], weak.at(16, 16)[0], 15);
}

}  // namespace
}  // namespace victorious

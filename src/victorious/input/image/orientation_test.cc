#include "victorious/input/image/orientation.h"

#include <array>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

namespace victorious {
namespace {

// The position of a stored pixel after RotateUpright, found by a single white pixel.
cv::Point PlaceAfter(Orientation orientation, cv::Point stored) {
  cv::Mat image = cv::Mat::zeros(3, 5, CV_8UC1);
  image.at<uchar>(stored) = 255;
  cv::Point place;
  cv::minMaxLoc(RotateUpright(image, orientation), nullptr, nullptr, nullptr, &place);
  return place;
}

TEST(Orientation, RotatesClockwise) {
  EXPECT_EQ(PlaceAfter(Orientation::kRotate90, {0, 0}), cv::Point(2, 0));
  EXPECT_EQ(PlaceAfter(Orientation::kRotate180, {0, 0}), cv::Point(4, 2));
  EXPECT_EQ(PlaceAfter(Orientation::kRotate270, {0, 0}), cv::Point(0, 4));
  EXPECT_EQ(ClockwiseRotationDeg(Orientation::kRotate270), 270);
}

TEST(Orientation, DisplayMatrixMatchesRotation) {
  for (int value = 1; value <= 8; ++value) {
    const Orientation orientation = OrientationFromExif(static_cast<std::uint32_t>(value));
    // The display matrix that corresponds to the orientation.
    const cv::Point origin = PlaceAfter(orientation, {0, 0});
    const cv::Point x_axis = PlaceAfter(orientation, {1, 0}) - origin;
    const cv::Point y_axis = PlaceAfter(orientation, {0, 1}) - origin;
    constexpr std::int32_t kOne = 1 << 16;
    const std::array<std::int32_t, 9> matrix = {
        x_axis.x * kOne, x_axis.y * kOne, 0, y_axis.x * kOne, y_axis.y * kOne, 0, 0, 0, 1 << 30};
    EXPECT_EQ(OrientationFromDisplayMatrix(matrix), orientation) << value;
    EXPECT_EQ(SwapsWidthAndHeight(orientation), RotateUpright(cv::Mat::zeros(3, 5, CV_8UC1), orientation).cols == 3);
  }
}

TEST(Orientation, UnknownValuesAreUpright) {
  EXPECT_EQ(OrientationFromExif(0), Orientation::kUpright);
  EXPECT_EQ(OrientationFromExif(9), Orientation::kUpright);
}

}  // namespace
}  // namespace victorious

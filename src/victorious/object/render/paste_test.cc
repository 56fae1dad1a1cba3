#include "victorious/object/render/paste.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

cv::Mat Grey(int width, int height, int level) { return {height, width, CV_8UC1, cv::Scalar(level)}; }

TEST(Paste, PastesMaskedPixelsByTheSimilarity) {
  cv::Mat object = Grey(40, 20, 200);
  cv::Mat mask = Grey(40, 20, 0);
  mask(cv::Rect(10, 5, 20, 10)) = 255;
  object.setTo(77, mask == 0);  // never visible
  cv::Mat image = Grey(100, 80, 50);
  Paste(object, mask, {.scale = 1, .rotation_rad = 0, .translation = {30, 40}}, image);
  cv::Mat expected = Grey(100, 80, 50);
  expected(cv::Rect(40, 45, 20, 10)) = 200;
  EXPECT_EQ(cv::countNonZero(image != expected), 0);
}

TEST(Paste, BlendsByTheMask) {
  cv::Mat image = Grey(10, 10, 50);
  Paste(Grey(10, 10, 200), Grey(10, 10, 128), {}, image);
  EXPECT_NEAR(image.at<std::uint8_t>(5, 5), 125, 1);
}

TEST(Paste, AveragesWhenDownscaling) {
  cv::Mat stripes = Grey(160, 160, 0);
  for (int column = 0; column < stripes.cols; column += 2) stripes.col(column) = 200;
  cv::Mat image = Grey(40, 40, 50);
  Paste(stripes, Grey(160, 160, 255), {.scale = 0.2, .rotation_rad = 0, .translation = {4, 4}}, image);
  EXPECT_NEAR(image.at<std::uint8_t>(20, 20), 100, 8);
  EXPECT_EQ(image.at<std::uint8_t>(1, 1), 50);
}

TEST(Paste, RotatesAndClipsAtTheEdge) {
  cv::Mat image = Grey(60, 60, 50);
  // A quarter turn clockwise: the horizontal bar becomes vertical, and half of it is clipped.
  Paste(Grey(40, 10, 200), Grey(40, 10, 255), {.scale = 1, .rotation_rad = kPi / 2, .translation = {30, 40}}, image);
  EXPECT_EQ(image.at<std::uint8_t>(55, 25), 200);
  EXPECT_EQ(image.at<std::uint8_t>(55, 35), 50);
  EXPECT_EQ(image.at<std::uint8_t>(35, 25), 50);
}

}  // namespace
}  // namespace victorious

#include "victorious/input/image/pixel_grid.h"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

namespace victorious {
namespace {

TEST(PixelGrid, StepGivesEightToTwentyLines) {
  EXPECT_EQ(PixelGridStep(640), 50);
  EXPECT_EQ(PixelGridStep(1280), 100);
  EXPECT_EQ(PixelGridStep(3840), 200);
  EXPECT_EQ(PixelGridStep(64), 10);
  for (int side = 200; side < 20000; side += 37) {
    const int lines = side / PixelGridStep(side);
    EXPECT_GE(lines, 8) << side;
    EXPECT_LE(lines, 20) << side;
  }
}

TEST(PixelGrid, LinesLieOnTheStepAndTheRestStays) {
  const cv::Mat before(480, 640, CV_8UC3, cv::Scalar(200, 100, 50));
  cv::Mat after = before.clone();
  DrawPixelGrid(after);
  const cv::Vec3b plain = before.at<cv::Vec3b>(0, 0);
  EXPECT_NE(after.at<cv::Vec3b>(225, 250), plain) << "on a line";
  EXPECT_NE(after.at<cv::Vec3b>(150, 325), plain) << "on a line";
  EXPECT_EQ(after.at<cv::Vec3b>(225, 235), plain) << "between lines";
  EXPECT_EQ(after.at<cv::Vec3b>(225, 251), plain) << "a line is one pixel wide";
  EXPECT_NE(after.at<cv::Vec3b>(147, 320), plain) << "a mark on a line";
  int changed = 0;
  for (int y = 0; y < after.rows; ++y) {
    for (int x = 0; x < after.cols; ++x) changed += after.at<cv::Vec3b>(y, x) != plain ? 1 : 0;
  }
  EXPECT_LT(changed, 0.25 * static_cast<double>(after.total()));
}

TEST(PixelGrid, TinyImagesAreAccepted) {
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(3, 400), cv::Size(40, 2)}) {
    cv::Mat image(size, CV_8UC3, cv::Scalar::all(90));
    DrawPixelGrid(image);
    EXPECT_EQ(image.size(), size);
  }
}

}  // namespace
}  // namespace victorious

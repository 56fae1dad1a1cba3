#include "victorious/search/recognize/upright_part.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace victorious {
namespace {

// A smooth image: what is cut out of it at any scale can be computed.
cv::Mat Ramp(const cv::Size& size) {
  cv::Mat grey(size, CV_8UC1);
  for (int row = 0; row < size.height; ++row) {
    for (int column = 0; column < size.width; ++column) {
      grey.at<std::uint8_t>(row, column) = cv::saturate_cast<std::uint8_t>(20 + 0.2 * column + 0.1 * row);
    }
  }
  return grey;
}

TEST(CutUpright, ShowsTheFrameAtAnyScaleAndLean) {
  const cv::Mat grey = Ramp({800, 600});
  const FramePyramid frame(grey);
  for (const double scale : {1.8, 1.0, 0.8, 0.6, 0.3, 0.1}) {
    for (const double lean_rad : {0.0, 0.4, -1.2}) {
      const UprightPart part = CutUpright(frame, {410.3, 287.6}, {120, 100}, scale, lean_rad);
      ASSERT_FALSE(part.grey.empty());
      for (const cv::Point at : {cv::Point(1, 1), cv::Point(part.grey.cols - 2, 3), cv::Point(4, part.grey.rows - 2)}) {
        const Eigen::Vector2d in_frame = part.ToFrame({at.x + 0.5, at.y + 0.5}) - Eigen::Vector2d(0.5, 0.5);
        EXPECT_NEAR(part.grey.at<std::uint8_t>(at), 20 + 0.2 * in_frame.x() + 0.1 * in_frame.y(), 1.6)
            << scale << ' ' << lean_rad;
      }
    }
  }
}

TEST(CutUpright, IsEmptyBesideTheFrame) {
  const cv::Mat grey = Ramp({200, 100});
  const FramePyramid frame(grey);
  EXPECT_TRUE(CutUpright(frame, {-80, 50}, {100, 100}, 0.5, 0).grey.empty());
  EXPECT_TRUE(CutUpright(frame, {100, 170}, {100, 100}, 0.5, 0).grey.empty());
  EXPECT_FALSE(CutUpright(frame, {-40, 50}, {100, 100}, 0.5, 0).grey.empty()) << "a part of it lies inside";
}

TEST(FramePyramid, HasLevelsThatAreLargeEnough) {
  const cv::Mat grey = Ramp({640, 480});
  const FramePyramid frame(grey);
  EXPECT_EQ(frame.LevelFor(2).cols, 640);
  EXPECT_EQ(frame.LevelFor(0.9).cols, 640);
  EXPECT_EQ(frame.LevelFor(0.5).cols, 320);
  EXPECT_EQ(frame.LevelFor(0.45).cols, 320);
  EXPECT_EQ(frame.LevelFor(0.4).cols, 269);
  EXPECT_EQ(frame.LevelFor(0.001).cols, 40) << "the smallest";
}

}  // namespace
}  // namespace victorious

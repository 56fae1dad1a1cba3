#include "victorious/category/network/image_placement.h"

#include <gtest/gtest.h>

namespace victorious {
namespace {

DetectorSettings Settings(ImageFit fit) { return {.width = 100, .height = 80, .fit = fit, .border = 7}; }

const cv::Mat& WideImage() {
  static const cv::Mat image(50, 200, CV_8UC3, cv::Scalar(10, 20, 30));
  return image;
}

TEST(PlaceImage, LetterboxIsInTheMiddle) {
  const PlacedImage placed = PlaceImage(WideImage(), Settings(ImageFit::kLetterbox));
  EXPECT_EQ(placed.input.size(), cv::Size(100, 80));
  EXPECT_EQ(placed.input.at<cv::Vec3b>(26, 50), cv::Vec3b(7, 7, 7));
  EXPECT_EQ(placed.input.at<cv::Vec3b>(28, 50), cv::Vec3b(10, 20, 30));
  EXPECT_EQ(placed.ToImage({10, 27, 50, 5}), (Box{20, 0, 100, 10}));
}

TEST(PlaceImage, CornerIsAtTheTopLeft) {
  const PlacedImage placed = PlaceImage(WideImage(), Settings(ImageFit::kCorner));
  EXPECT_EQ(placed.input.at<cv::Vec3b>(24, 99), cv::Vec3b(10, 20, 30));
  EXPECT_EQ(placed.input.at<cv::Vec3b>(25, 0), cv::Vec3b(7, 7, 7));
  EXPECT_EQ(placed.ToImage({10, 5, 50, 5}), (Box{20, 10, 100, 10}));
}

TEST(PlaceImage, SqueezedHasTwoScales) {
  const PlacedImage placed = PlaceImage(WideImage(), Settings(ImageFit::kSqueeze));
  EXPECT_EQ(placed.input.at<cv::Vec3b>(79, 99), cv::Vec3b(10, 20, 30));
  EXPECT_EQ(placed.ToImage({10, 8, 50, 16}), (Box{20, 5, 100, 10}));
}

TEST(TilesOf, CoverTheImageAndOverlap) {
  const cv::Size image(1920, 1080);
  const auto tiles = TilesOf(image, {416, 416}, 0.2);
  cv::Mat covered = cv::Mat::zeros(image, CV_8U);
  for (const cv::Rect& tile : tiles) {
    EXPECT_EQ(tile.size(), cv::Size(416, 416));
    ASSERT_EQ(tile & cv::Rect({0, 0}, image), tile);
    covered(tile) = 1;
  }
  EXPECT_EQ(cv::countNonZero(covered), image.area());
  EXPECT_EQ(tiles.size(), 6 * 3);
  for (std::size_t i = 1; i < 6; ++i) EXPECT_GE(tiles[i - 1].br().x - tiles[i].x, 0.2 * 416 - 1);
}

TEST(TilesOf, AreNoLargerThanTheImage) {
  const auto tiles = TilesOf({640, 300}, {416, 416}, 0);
  ASSERT_EQ(tiles.size(), 2);
  EXPECT_EQ(tiles[0], cv::Rect(0, 0, 416, 300));
  EXPECT_EQ(tiles[1], cv::Rect(224, 0, 416, 300));
}

}  // namespace
}  // namespace victorious

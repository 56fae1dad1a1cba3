#include "victorious/input/image/grey_range.h"

#include <cstdint>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace victorious {
namespace {

constexpr double kWhite = 65535;

// A ramp over a range of counts, as of a thermal camera.
cv::Mat Ramp(double low, double high) {
  cv::Mat image(40, 100, CV_16UC1);
  for (int x = 0; x < image.cols; ++x) image.col(x).setTo(low + (high - low) * x / (image.cols - 1));
  return image;
}

double Contrast(const cv::Mat& grey) {
  double least = 0;
  double most = 0;
  cv::minMaxLoc(grey, &least, &most);
  return most - least;
}

TEST(GreyRange, FewCountsAreStretched) {
  GreyRange range;
  EXPECT_GT(Contrast(range.ToEightBits(Ramp(7200, 8100), kWhite)), 120) << "by the upper byte alone: 4 levels";
  EXPECT_EQ(range.Describe(), "grey images with values of 7200 to 8100 of 65535: they are stretched to full contrast");
}

TEST(GreyRange, ASequenceHasOneScale) {
  GreyRange range;
  const cv::Mat first = range.ToEightBits(Ramp(7200, 8100), kWhite);
  const cv::Mat part = range.ToEightBits(Ramp(7200, 7650), kWhite);
  EXPECT_EQ(first.at<std::uint8_t>(0, 0), part.at<std::uint8_t>(0, 0));
  EXPECT_NEAR(Contrast(part), Contrast(first) / 2, 2);
  const cv::Mat hotter = range.ToEightBits(Ramp(7200, 12000), kWhite);
  EXPECT_LT(cv::mean(hotter == 255)[0], 0.02 * 255) << "the range widens";
}

TEST(GreyRange, AnImageThatUsesItsValuesIsScaled) {
  GreyRange range;
  const cv::Mat grey = range.ToEightBits(Ramp(0, 65535), kWhite);
  EXPECT_EQ(grey.at<std::uint8_t>(0, 99), 255);
  EXPECT_FALSE(range.Describe());
  const cv::Mat dark = range.ToEightBits(Ramp(7200, 8100), kWhite);
  EXPECT_EQ(dark.at<std::uint8_t>(0, 0), 28) << "as decided by the first image";
}

TEST(GreyRange, DecodedImagesAreStretched) {
  std::vector<unsigned char> png;
  ASSERT_TRUE(cv::imencode(".png", Ramp(7200, 8100), png));
  const auto image = DecodeImage(std::as_bytes(std::span(png)), "thermal.png");
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_GT(Contrast(GreyFromBgr(image->bgr)), 120);
}

}  // namespace
}  // namespace victorious

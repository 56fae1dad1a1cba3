#include "victorious/input/image/degrade.h"

#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

namespace victorious {
namespace {

constexpr std::uint64_t kNoiseSeed = 41;

cv::Mat Grey() { return {200, 300, CV_8UC3, cv::Scalar(120, 120, 120)}; }

cv::Mat Degraded(const DegradeOptions& options, std::uint64_t seed) {
  cv::Mat image = Grey();
  Degrade(options, seed, image);
  return image;
}

double FractionOf(const cv::Mat& image, const cv::Scalar& colour) {
  cv::Mat mask;
  cv::inRange(image, colour, colour, mask);
  return cv::countNonZero(mask) / static_cast<double>(image.total());
}

TEST(Degrade, DefaultIsIdentity) { EXPECT_EQ(cv::norm(Degraded({}, kNoiseSeed), Grey(), cv::NORM_INF), 0); }

TEST(Degrade, SaltAndPepperHaveTheGivenFraction) {
  const cv::Mat noisy = Degraded({.noise = 0.15}, kNoiseSeed);
  EXPECT_NEAR(FractionOf(noisy, {255, 255, 255}), 0.075, 0.006);
  EXPECT_NEAR(FractionOf(noisy, {0, 0, 0}), 0.075, 0.006);
  EXPECT_NEAR(FractionOf(noisy, {120, 120, 120}), 0.85, 0.01);
}

TEST(Degrade, GaussianNoiseHasItsSigmaInEachChannel) {
  cv::Scalar mean;
  cv::Scalar sigma;
  cv::meanStdDev(Degraded({.grain = 6}, kNoiseSeed), mean, sigma);
  for (int channel = 0; channel < 3; ++channel) {
    EXPECT_NEAR(mean[channel], 120, 0.2);
    EXPECT_NEAR(sigma[channel], 6, 0.2);
  }
}

TEST(Degrade, BlurPrecedesNoise) {
  cv::Mat image = Grey();
  image.colRange(150, 300).setTo(cv::Scalar(220, 220, 220));
  Degrade({.blur_px = 2, .noise = 0.05}, kNoiseSeed, image);
  // The edge is blurred, but the salt-and-pepper pixels on it are fully white and black.
  EXPECT_GT(FractionOf(image, {255, 255, 255}), 0.02);
  int between = 0;
  for (int row = 0; row < image.rows; ++row) {
    const int grey = image.at<cv::Vec3b>(row, 150)[0];
    between += grey > 160 && grey < 215 ? 1 : 0;
  }
  EXPECT_GT(between, 150);
}

TEST(Degrade, NoiseIsDeterministicBySeed) {
  const DegradeOptions options{.grain = 2, .noise = 0.02};
  EXPECT_EQ(cv::norm(Degraded(options, kNoiseSeed), Degraded(options, kNoiseSeed), cv::NORM_INF), 0);
  EXPECT_GT(cv::norm(Degraded(options, kNoiseSeed), Degraded(options, kNoiseSeed + 1), cv::NORM_INF), 0);
}

}  // namespace
}  // namespace victorious

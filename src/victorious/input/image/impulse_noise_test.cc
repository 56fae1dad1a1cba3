#include "victorious/input/image/impulse_noise.h"

#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "victorious/base/random.h"

namespace victorious {
namespace {

// A smooth grey image without noise.
cv::Mat Hills() {
  cv::Mat image(120, 160, CV_8UC1);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      image.at<uchar>(y, x) = cv::saturate_cast<uchar>(128 + 50 * std::sin(x / 9.0) + 40 * std::cos(y / 7.0));
    }
  }
  return image;
}

// @param spread  grey levels that an impulse may be from black or white, as after compression
cv::Mat WithSaltAndPepper(cv::Mat image, double share, std::uint32_t spread = 0) {
  Random random(1);
  const auto impulse = [&] {
    const int off = spread > 0 ? static_cast<int>(random.Below(spread)) : 0;
    return static_cast<uchar>(random.Below(2) == 0 ? off : 255 - off);
  };
  for (int i = 0; i < share * static_cast<double>(image.total()); ++i) {
    image.at<uchar>(static_cast<int>(random.Below(static_cast<std::uint32_t>(image.rows))),
                    static_cast<int>(random.Below(static_cast<std::uint32_t>(image.cols)))) = impulse();
  }
  return image;
}

TEST(ImpulseNoise, RemovesSaltAndPepper) {
  const cv::Mat clean = Hills();
  for (const double share : {0.02, 0.03, 0.07, 0.15}) {
    const cv::Mat noisy = WithSaltAndPepper(clean.clone(), share);
    const double before = cv::norm(noisy, clean, cv::NORM_L1) / static_cast<double>(clean.total());
    const double after =
        cv::norm(RemoveImpulses(noisy, 0.015), clean, cv::NORM_L1) / static_cast<double>(clean.total());
    EXPECT_LT(after, before / 15) << share;
  }
}

// Thin lines differ from their surroundings as much as impulses do, but are neither black nor white.
TEST(ImpulseNoise, KeepsLinesBesideImpulses) {
  cv::Mat clean(240, 320, CV_8UC1, cv::Scalar(150));
  for (int i = 0; i < 10; ++i) cv::line(clean, {10 + 30 * i, 5}, {20 + 30 * i, 235}, cv::Scalar(i % 2 == 0 ? 95 : 205));
  for (const std::uint32_t spread : {0U, 20U}) {
    const cv::Mat noisy = WithSaltAndPepper(clean.clone(), 0.07, spread);
    const cv::Mat cleaned = RemoveImpulses(noisy, 0.015);
    const cv::Mat lines = (clean != 150) & (noisy == clean);
    const cv::Mat changed = cleaned != clean;
    EXPECT_EQ(cv::countNonZero(changed & lines), 0) << spread;
    EXPECT_LT(cv::norm(cleaned, clean, cv::NORM_L1), cv::norm(noisy, clean, cv::NORM_L1) / 15) << spread;
  }
}

// A bright line on a black surface may be as dark as pepper is.
TEST(ImpulseNoise, KeepsLinesAsDarkAsPepper) {
  cv::Mat clean(240, 320, CV_8UC1, cv::Scalar(150));
  const cv::Rect black(100, 60, 120, 120);
  clean(black).setTo(5);
  cv::line(clean, {110, 80}, {200, 160}, cv::Scalar(36));
  const cv::Mat noisy = WithSaltAndPepper(clean.clone(), 0.07, 20);
  const cv::Mat line = (clean == 36) & (noisy == clean);
  const cv::Mat changed = RemoveImpulses(noisy, 0.015) != clean;
  EXPECT_EQ(cv::countNonZero(changed & line), 0);
}

// In snow flat regions show pepper only.
TEST(ImpulseNoise, RemovesSaltFromDarkDetailsInSnow) {
  cv::Mat clean(240, 320, CV_8UC1, cv::Scalar(235));
  const cv::Rect dark(100, 60, 100, 100);
  for (int y = dark.y; y < dark.br().y; ++y) {
    for (int x = dark.x; x < dark.br().x; ++x)
      clean.at<uchar>(y, x) = static_cast<uchar>(40 + 30 * ((x / 3 + y / 3) % 2));
  }
  const cv::Mat cleaned = RemoveImpulses(WithSaltAndPepper(clean.clone(), 0.07), 0.015);
  EXPECT_EQ(cv::countNonZero(cleaned(dark) > 200), 0);
}

// Pepper on a dark surface, which few grey levels separate from it, is known by its level elsewhere.
TEST(ImpulseNoise, RemovesPepperFromDarkSurfaces) {
  cv::Mat clean = Hills();
  const cv::Rect dark(40, 30, 60, 50);
  clean(dark).setTo(28);
  const cv::Mat cleaned = RemoveImpulses(WithSaltAndPepper(clean.clone(), 0.07), 0.015);
  EXPECT_EQ(cv::countNonZero(cleaned(dark) < 20), 0);
}

TEST(ImpulseNoise, FromAFractionOfOneOnNothingIsRemoved) {
  const cv::Mat noisy = WithSaltAndPepper(Hills(), 0.15);
  EXPECT_EQ(RemoveImpulses(noisy, 1).data, noisy.data);
}

// In a dark image only salt differs from the background.
TEST(ImpulseNoise, IsDetectedInDarkImages) {
  const cv::Mat clean = Hills() / 6;
  const cv::Mat noisy = WithSaltAndPepper(clean.clone(), 0.03);
  EXPECT_LT(cv::norm(RemoveImpulses(noisy, 0.015), clean, cv::NORM_L1), cv::norm(noisy, clean, cv::NORM_L1) / 5);
}

TEST(ImpulseNoise, KeepsCleanImagesWithBrightPoints) {
  cv::Mat clean = Hills();
  for (int i = 0; i < 20; ++i) clean.at<uchar>(5 + 5 * i, 8 + 7 * i) = 255;
  EXPECT_EQ(cv::norm(RemoveImpulses(clean, 0.015), clean, cv::NORM_INF), 0);
}

// Thin branches, letters and dots differ from their surroundings as impulses do: in every tenth pixel of this image.
TEST(ImpulseNoise, KeepsCleanImagesWithThinStructures) {
  cv::Mat clean(240, 320, CV_8UC1, cv::Scalar(150));
  Random random(2);
  for (int i = 0; i < 150; ++i) {
    const cv::Point from(static_cast<int>(random.Below(320)), static_cast<int>(random.Below(240)));
    const cv::Point to(static_cast<int>(random.Below(320)), static_cast<int>(random.Below(240)));
    cv::line(clean, from, to, cv::Scalar(random.Below(2) == 0 ? 30 : 240));
  }
  EXPECT_EQ(cv::norm(RemoveImpulses(clean, 0.015), clean, cv::NORM_INF), 0);
  const cv::Mat noisy = WithSaltAndPepper(clean.clone(), 0.05);
  EXPECT_GT(cv::norm(RemoveImpulses(noisy, 0.015), noisy, cv::NORM_INF), 0) << "this one is noisy";
}

// The number of impulses over the flat area decides, here 80 of 40,000 pixels.
TEST(ImpulseNoise, ComparesWithTheFlatArea) {
  cv::Mat image(200, 200, CV_8UC1, cv::Scalar(100));
  for (int i = 0; i < 80; ++i) image.at<uchar>(4 + 20 * (i / 8), 4 + 24 * (i % 8)) = i % 2 == 0 ? 255 : 0;
  for (const double more : {0.0021, 0.003, 0.09, 0.11, 0.9}) {
    EXPECT_EQ(cv::norm(RemoveImpulses(image, more), image, cv::NORM_INF), 0) << more;
  }
  for (const double less : {0.0, 0.0001, 0.0019}) {
    EXPECT_EQ(cv::norm(RemoveImpulses(image, less), cv::Mat(200, 200, CV_8UC1, cv::Scalar(100)), cv::NORM_INF), 0)
        << less;
  }
}

TEST(ImpulseNoise, AcceptsImagesOfAnySize) {
  for (const int side : {0, 1, 4, 5}) {
    const cv::Mat tiny(side, side, CV_8UC1, cv::Scalar(7));
    EXPECT_EQ(RemoveImpulses(tiny, 0.0).size(), tiny.size()) << side;
  }
}

}  // namespace
}  // namespace victorious

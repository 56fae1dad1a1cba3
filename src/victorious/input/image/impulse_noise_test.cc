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

cv::Mat WithSaltAndPepper(cv::Mat image, double share) {
  Random random(1);
  for (int i = 0; i < share * static_cast<double>(image.total()); ++i) {
    image.at<uchar>(static_cast<int>(random.Below(static_cast<std::uint32_t>(image.rows))),
                    static_cast<int>(random.Below(static_cast<std::uint32_t>(image.cols)))) =
        random.Below(2) == 0 ? 0 : 255;
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

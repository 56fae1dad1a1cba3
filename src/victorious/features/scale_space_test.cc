#include "victorious/features/scale_space.h"

#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "victorious/base/random.h"
#include "victorious/features/feature_extractor.h"

namespace victorious {
namespace {

cv::Mat Noise(int width, int height, std::uint64_t seed) {
  Random random(seed);
  cv::Mat image(height, width, CV_8UC1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) image.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(random.Below(256));
  }
  cv::GaussianBlur(image, image, cv::Size(), 1.0);
  return image;
}

// The textbook: one Gaussian of the doubled image per level, in single precision.
TEST(ScaleSpace, LevelsAreGaussiansOfTheDoubledImage) {
  const cv::Mat image = Noise(120, 110, 1);
  ScaleSpace space;
  space.Build(image, 1);
  cv::Mat floats;
  image.convertTo(floats, CV_32F);
  cv::Mat doubled;
  cv::resize(floats, doubled, cv::Size(), 2, 2, cv::INTER_LINEAR);
  for (std::size_t l = 0; l < kernels::kLevels; ++l) {
    const double sigma = kFirstLayerSigma_px * std::pow(2.0, static_cast<double>(l) / kOctaveLayers);
    cv::Mat expected;
    cv::GaussianBlur(doubled, expected, cv::Size(61, 61), std::sqrt(sigma * sigma - 1));
    const kernels::LevelView& level = space.octaves()[0][l];
    double squares = 0;
    int count = 0;
    for (int y = 40; y < level.height - 40; ++y) {
      for (int x = 40; x < level.width - 40; ++x, ++count) {
        const double grey = (level.Row(y)[x] + kernels::kLevelOffset) / static_cast<double>(kernels::kLevelUnit);
        squares += std::pow(grey - expected.at<float>(y, x), 2);
      }
    }
    EXPECT_LT(std::sqrt(squares / count), 0.06) << "level " << l;  // grey levels
  }
}

TEST(ScaleSpace, OctavesHalveUntilNothingIsSearched) {
  ScaleSpace space;
  space.Build(Noise(100, 40, 2), 1);
  ASSERT_EQ(space.octaves().size(), 3U);
  EXPECT_EQ(space.octaves()[0][0].width, 200);
  EXPECT_EQ(space.octaves()[2][5].width, 50);
  EXPECT_EQ(space.octaves()[2][5].height, 20);
  const kernels::LevelView& last = space.octaves()[0][kOctaveLayers];
  const kernels::LevelView& first = space.octaves()[1][0];
  for (int y = 0; y < first.height; ++y) {
    for (int x = 0; x < first.width; ++x) ASSERT_EQ(first.Row(y)[x], last.Row(2 * y)[2 * x]);
  }
}

TEST(ScaleSpace, ExtremaAreOrderedAndStandOut) {
  ScaleSpace space;
  space.Build(Noise(150, 170, 3), 2);
  ASSERT_GT(space.extrema().size(), 50U);
  std::uint64_t before = 0;
  for (const GridExtremum& at : space.extrema()) {
    EXPECT_GT(at.Order(), before);
    before = at.Order();
    const OctaveLevels& levels = space.octaves()[static_cast<std::size_t>(at.octave)];
    const auto layer = static_cast<std::size_t>(at.layer);
    EXPECT_GT(std::abs(levels[layer + 1].Row(at.y)[at.x] - levels[layer].Row(at.y)[at.x]), 2 * kernels::kLevelUnit);
  }
  const std::vector<GridExtremum> once = space.extrema();
  space.Build(Noise(80, 60, 4), 2);
  space.Build(Noise(150, 170, 3), 2);  // in used memory
  EXPECT_EQ(space.extrema(), once);
}

}  // namespace
}  // namespace victorious

#include "victorious/object/features/scale_space.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>
#include <opencv2/imgproc.hpp>

#include "victorious/base/random.h"
#include "victorious/object/features/feature_extractor.h"

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

// Rounding may lift white from octave to octave; the sum of two pixels must fit into 16 bits (kernels/blur.h).
TEST(ScaleSpace, WhiteAndBlackStayInRange) {
  for (const int grey : {0, 255}) {
    ScaleSpace space;
    space.Build(cv::Mat(1024, 1024, CV_8UC1, cv::Scalar(grey)), 1);
    int largest = 0;
    for (const auto& octave : space.octaves()) {
      for (const kernels::LevelView& level : octave) {
        for (int y = 0; y < level.height; ++y) {
          for (int x = 0; x < level.width; ++x) largest = std::max(largest, std::abs(int{level.Row(y)[x]}));
        }
      }
    }
    EXPECT_LE(largest, kernels::kLevelOffset + 63) << grey;
  }
}

int Mirror(int i, int count) {
  while (i < 0 || i >= count) i = i < 0 ? -i : 2 * (count - 1) - i;
  return i;
}

// Level l - 1 blurred in two passes by the reference kernels, mirrored at the borders.
std::vector<std::int16_t> BlurLevel(const kernels::LevelView& level, const kernels::BlurTaps& taps) {
  const auto width = static_cast<std::size_t>(level.width);
  const auto radius = static_cast<std::size_t>(taps.radius);
  std::vector<std::int16_t> result;
  for (int y = 0; y < level.height; ++y) {
    std::vector<const std::int16_t*> rows;
    for (int k = -taps.radius; k <= taps.radius; ++k) rows.push_back(level.Row(Mirror(y + k, level.height)));
    std::vector<std::int16_t> column_sums(width);
    kernels::BlurColumnsRef(rows.data(), taps, width, column_sums.data());
    std::vector<std::int16_t> line;
    for (int x = -taps.radius; x < level.width + taps.radius; ++x) {
      line.push_back(column_sums[static_cast<std::size_t>(Mirror(x, level.width))]);
    }
    std::vector<std::int16_t> out(width);
    kernels::BlurRowRef(line.data() + radius, taps, width, out.data());
    result.insert(result.end(), out.begin(), out.end());
  }
  return result;
}

TEST(ScaleSpace, EveryLevelIsTheBlurOfTheOneBelow) {
  const oneapi::tbb::global_control allow(oneapi::tbb::global_control::max_allowed_parallelism, 4);
  for (const cv::Size size :
       {cv::Size(33, 240), cv::Size(37, 20), cv::Size(200, 331), cv::Size(64, 9), cv::Size(97, 30)}) {
    ScaleSpace space;
    oneapi::tbb::task_arena(4).execute([&] { space.Build(Noise(size.width, size.height, 5), 1); });
    for (const OctaveLevels& levels : space.octaves()) {
      for (std::size_t l = 1; l < kernels::kLevels; ++l) {
        const double below = kFirstLayerSigma_px * std::pow(2.0, static_cast<double>(l - 1) / kOctaveLayers);
        const double sigma = kFirstLayerSigma_px * std::pow(2.0, static_cast<double>(l) / kOctaveLayers);
        const auto expected = BlurLevel(levels[l - 1], kernels::MakeBlurTaps(std::sqrt(sigma * sigma - below * below)));
        std::vector<std::int16_t> level;
        for (int y = 0; y < levels[l].height; ++y) {
          level.insert(level.end(), levels[l].Row(y), levels[l].Row(y) + levels[l].width);
        }
        ASSERT_EQ(level, expected) << size << " level " << l;
      }
    }
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

TEST(ScaleSpace, ExtremaAreDistinctAndStandOut) {
  const auto sorted = [](std::vector<GridExtremum> extrema) {
    std::ranges::sort(extrema, {}, &GridExtremum::Order);
    return extrema;
  };
  ScaleSpace space;
  space.Build(Noise(150, 170, 3), 2);
  const std::vector<GridExtremum> once = sorted(space.extrema());
  ASSERT_GT(once.size(), 50U);
  std::uint64_t before = 0;
  for (const GridExtremum& at : once) {
    EXPECT_GT(at.Order(), before);
    before = at.Order();
    const OctaveLevels& levels = space.octaves()[static_cast<std::size_t>(at.octave)];
    const auto layer = static_cast<std::size_t>(at.layer);
    EXPECT_GT(std::abs(levels[layer + 1].Row(at.y)[at.x] - levels[layer].Row(at.y)[at.x]), 2 * kernels::kLevelUnit);
  }
  space.Build(Noise(80, 60, 4), 2);
  space.Build(Noise(150, 170, 3), 2);  // in used memory
  EXPECT_EQ(sorted(space.extrema()), once);
}

}  // namespace
}  // namespace victorious

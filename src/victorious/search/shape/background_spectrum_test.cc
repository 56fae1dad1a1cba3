#include "victorious/search/shape/background_spectrum.h"

#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "victorious/base/random.h"

namespace victorious {
namespace {

constexpr int kSide = 8;

// Cells in which every second column repeats the one before: a background whose neighbours tell each other.
GradientCells Background(std::uint64_t seed, bool is_smooth) {
  Random random(seed);
  GradientCells cells{.rows = 120, .columns = 160, .codes = {}};
  cells.codes.resize(static_cast<std::size_t>(cells.rows) * cells.columns * kCellOrientations);
  for (int row = 0; row < cells.rows; ++row) {
    for (int column = 0; column < cells.columns; ++column) {
      for (int k = 0; k < kCellOrientations; ++k) {
        auto& code = cells.codes[(static_cast<std::size_t>(row) * cells.columns + column) * kCellOrientations + k];
        code = is_smooth && column >= 8 && column % 8 != 0 ? cells.at(row, column - 1)[k]
                                                           : static_cast<std::uint8_t>(random.Below(200));
      }
    }
  }
  return cells;
}

CellTemplate Pattern(std::uint64_t seed) {
  Random random(seed);
  CellTemplate cells{.rows = kSide, .columns = kSide, .values = {}};
  for (int i = 0; i < kSide * kSide * kCellOrientations; ++i) {
    cells.values.push_back(static_cast<float>(random.Uniform(-0.4, 0.4)));
  }
  return cells;
}

// The responses of weights at every place of a background.
std::vector<double> Responses(const CellTemplate& weights, const GradientCells& background,
                              const BackgroundSpectrum& spectrum) {
  constexpr int kStride = kCellSide_px / kCellStep_px;
  std::vector<double> responses;
  for (int top = 0; top + kStride * kSide <= background.rows; ++top) {
    for (int left = 0; left + kStride * kSide <= background.columns; ++left) {
      double sum = 0;
      for (int row = 0; row < kSide; ++row) {
        for (int column = 0; column < kSide; ++column) {
          for (int k = 0; k < kCellOrientations; ++k) {
            const double value =
                background.at(top + kStride * row, left + kStride * column)[k] * (kMaxCellValue / kMaxCellCode);
            sum += weights.at(row, column, k) * (value - spectrum.mean()[static_cast<std::size_t>(k)]);
          }
        }
      }
      responses.push_back(sum);
    }
  }
  return responses;
}

double Deviation(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value * value;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

TEST(BackgroundSpectrum, HasTheMeanOfTheBackground) {
  GradientCells cells{.rows = 40, .columns = 40, .codes = std::vector<std::uint8_t>(40 * 40 * kCellOrientations, 51)};
  const BackgroundSpectrum spectrum({&cells, 1}, kSide);
  for (const float mean : spectrum.mean()) EXPECT_NEAR(mean, 51 * kMaxCellValue / kMaxCellCode, 1e-5);
}

TEST(BackgroundSpectrum, ResponsesToBackgroundHaveUnitVarianceAtMost) {
  for (const bool is_smooth : {false, true}) {
    const GradientCells seen = Background(1, is_smooth);
    const BackgroundSpectrum spectrum({&seen, 1}, kSide);
    const double deviation = Deviation(Responses(spectrum.Whiten(Pattern(5)), Background(2, is_smooth), spectrum));
    EXPECT_LT(deviation, 1.1) << is_smooth;
    EXPECT_GT(deviation, 0.5) << is_smooth;
  }
}

TEST(BackgroundSpectrum, WithoutBackgroundWeightsAreTheTemplateOfUnitLength) {
  const BackgroundSpectrum spectrum({}, kSide);
  const CellTemplate pattern = Pattern(3);
  const CellTemplate weights = spectrum.Whiten(pattern);
  double length = 0;
  for (const float value : pattern.values) length += value * value;
  for (std::size_t i = 0; i < pattern.values.size(); ++i) {
    EXPECT_NEAR(weights.values[i], pattern.values[i] / std::sqrt(length), 1e-5);
  }
}

TEST(BackgroundSpectrum, WhitensNothingToNothing) {
  const BackgroundSpectrum spectrum({}, kSide);
  const CellTemplate empty{
      .rows = kSide, .columns = kSide, .values = std::vector<float>(kSide * kSide * kCellOrientations)};
  for (const float weight : spectrum.Whiten(empty).values) EXPECT_EQ(weight, 0);
}

}  // namespace
}  // namespace victorious

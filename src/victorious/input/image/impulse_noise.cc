#include "victorious/input/image/impulse_noise.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <optional>
#include <vector>

#include <opencv2/imgproc.hpp>

namespace victorious {
namespace {

// Chosen on renderings with salt-and-pepper noise (`simulate`, compressed as video); not fitted.
// Grey levels of an impulse of unknown level from its 3 x 3 median; lower values detect codec ringing around one.
constexpr int kMinDeviation = 35;
constexpr int kMinKnownDeviation = 20;     // of one at the level of impulses, which ringing does not reach
constexpr double kLevelQuantile = 0.9;     // of the distances of impulses from black or white
constexpr int kLevelMargin = 10;           // grey levels beyond twice that quantile
constexpr int kMaxLevelReach = 60;         // grey levels from black or white; details have the levels beyond, too
constexpr std::size_t kMinImpulses = 30;   // that show a level
constexpr int kMaxReach = 3;               // px, radius of the pixels that replace an impulse
constexpr int kMaxSetNeighbours = 1;       // an isolated pixel has at most so many among its eight
constexpr int kMaxFlatRange = 20;          // grey levels, bound on the range of the 3 x 3 medians
constexpr double kMinFlatFraction = 0.02;  // minimum denominator, fraction of the image: robust to few flat pixels

// One row of the masks and ranges of ImpulseFraction, with one pixel beside the image on either side.
struct NoiseRow {
  explicit NoiseRow(std::size_t width)
      : above(width + 2), below(width + 2), highest(width + 2), lowest(width + 2, 255) {}

  std::vector<uchar> above;    // 1: brighter than the median by more than kMinDeviation
  std::vector<uchar> below;    // 1: darker
  std::vector<uchar> highest;  // median
  std::vector<uchar> lowest;   // median
};

// The loops over pixels are simple ones on bytes, which the compiler vectorises.

void MarkDeviations(std::size_t count, const uchar* __restrict higher, const uchar* __restrict lower,
                    uchar* __restrict marks) {
  for (std::size_t x = 0; x < count; ++x) {
    const auto deviation = static_cast<uchar>(std::max(higher[x], lower[x]) - lower[x]);
    marks[x] = deviation > kMinDeviation ? 1 : 0;
  }
}

void FillRow(const uchar* grey, const uchar* median, std::size_t width, NoiseRow& row) {
  MarkDeviations(width, grey, median, row.above.data() + 1);
  MarkDeviations(width, median, grey, row.below.data() + 1);
  std::copy_n(median, width, row.highest.data() + 1);
  std::copy_n(median, width, row.lowest.data() + 1);
}

// out = join(a, b, c), of `count` pixels.
template <typename Join>
void JoinPixels(std::size_t count, const uchar* __restrict a, const uchar* __restrict b, const uchar* __restrict c,
                uchar* __restrict out, const Join& join) {
  for (std::size_t x = 0; x < count; ++x) out[x] = join(join(a[x], b[x]), c[x]);
}

constexpr auto kAdd = [](uchar a, uchar b) { return static_cast<uchar>(a + b); };
constexpr auto kMax = [](uchar a, uchar b) { return std::max(a, b); };
constexpr auto kMin = [](uchar a, uchar b) { return std::min(a, b); };

// Of each 3 x 3: the sums of the masks, and the range of the medians.
// @param across  of three rows, of the width of a NoiseRow; it is overwritten
// @param around  of `width` pixels
void JoinRows(const std::array<const NoiseRow*, 3>& rows, std::size_t width, NoiseRow& across, NoiseRow& around) {
  const auto join = [&](std::vector<uchar> NoiseRow::* of, const auto& how) {
    uchar* const column = (across.*of).data();
    JoinPixels(width + 2, (rows[0]->*of).data(), (rows[1]->*of).data(), (rows[2]->*of).data(), column, how);
    JoinPixels(width, column, column + 1, column + 2, (around.*of).data(), how);
  };
  join(&NoiseRow::above, kAdd);
  join(&NoiseRow::below, kAdd);
  join(&NoiseRow::highest, kMax);
  join(&NoiseRow::lowest, kMin);
}

// Pixels of flat regions that are dark (or bright) enough for an impulse, and those of them that are one.
struct FlatCounts {
  std::uint32_t candidates = 0;
  std::uint32_t impulses = 0;

  [[nodiscard]] double Fraction(double min_candidates) const {
    return impulses / std::max<double>(candidates, min_candidates);
  }
};

bool IsFlat(uchar highest, uchar lowest) { return static_cast<uchar>(highest - lowest) < kMaxFlatRange; }

// @param outliers_around  with the outlier itself
bool IsIsolated(uchar outliers_around) { return outliers_around <= 1 + kMaxSetNeighbours; }

// An impulse is an isolated outlier.
// @param invert  255: for brighter outliers, of dark pixels; 0: for darker ones
void CountImpulses(std::size_t count, const uchar* __restrict median, uchar invert, const uchar* __restrict highest,
                   const uchar* __restrict lowest, const uchar* __restrict outliers,
                   const uchar* __restrict outliers_around, FlatCounts& counts) {
  std::uint32_t candidates = 0;
  std::uint32_t impulses = 0;
  for (std::size_t x = 0; x < count; ++x) {
    const uchar headroom = median[x] ^ invert;
    const uchar is_candidate = (IsFlat(highest[x], lowest[x]) ? 1 : 0) & (headroom > kMinDeviation ? 1 : 0);
    candidates += is_candidate;
    impulses += is_candidate & outliers[x] & (IsIsolated(outliers_around[x]) ? 1 : 0);
  }
  counts.candidates += candidates;
  counts.impulses += impulses;
}

// Calls visit(y, the row's marks, their sums and the range of the medians around) for each row from the first one.
template <typename Visit>
void VisitRows(const cv::Mat& grey, const cv::Mat& median, const Visit& visit) {
  const auto width = static_cast<std::size_t>(grey.cols);
  const NoiseRow outside(width);
  std::array<NoiseRow, 3> rows = {outside, outside, outside};  // of row y: y % 3
  NoiseRow across(width);
  NoiseRow around(width);
  FillRow(grey.ptr(0), median.ptr(0), width, rows[0]);
  for (int y = 0; y < grey.rows; ++y) {
    const bool is_last = y + 1 == grey.rows;
    if (!is_last) FillRow(grey.ptr(y + 1), median.ptr(y + 1), width, rows[(y + 1U) % 3]);
    const NoiseRow& middle = rows[y % 3U];
    JoinRows({&rows[(y + 2U) % 3], &middle, is_last ? &outside : &rows[(y + 1U) % 3]}, width, across, around);
    visit(y, middle, around);
  }
}

// The fraction of impulses in flat regions: of salt among pixels dark enough for it, plus of pepper among pixels bright
// enough. In flat regions isolated outliers are noise; elsewhere also thin lines, leaves and print.
double ImpulseFraction(const cv::Mat& grey, const cv::Mat& median) {
  FlatCounts salt;
  FlatCounts pepper;
  VisitRows(grey, median, [&](int y, const NoiseRow& middle, const NoiseRow& around) {
    const auto count = [&](uchar invert, std::vector<uchar> NoiseRow::* of, FlatCounts& counts) {
      CountImpulses(static_cast<std::size_t>(grey.cols), median.ptr(y), invert, around.highest.data(),
                    around.lowest.data(), (middle.*of).data() + 1, (around.*of).data(), counts);
    };
    count(255, &NoiseRow::above, salt);
    count(0, &NoiseRow::below, pepper);
  });
  const double min_candidates = kMinFlatFraction * static_cast<double>(grey.total());
  return salt.Fraction(min_candidates) + pepper.Fraction(min_candidates);
}

// Which pixels are impulses of one kind: those at most `reach` grey levels from black (or white) that differ towards it
// from the median.
struct ImpulseRule {
  int reach = 255;
  int min_deviation = kMinDeviation;  // from the 3 x 3 median; twice that from the 5 x 5 median, for pairs of impulses

  [[nodiscard]] bool Matches(int distance, int deviation, int wider_deviation) const {
    return (deviation > min_deviation || wider_deviation > 2 * min_deviation) & (distance <= reach);
  }
};

// @param distances  how many impulses lie so far from black or white
std::optional<ImpulseRule> RuleFrom(const std::array<std::size_t, 256>& distances) {
  const auto count = std::accumulate(distances.begin(), distances.end(), std::size_t{0});
  if (count < kMinImpulses) return std::nullopt;
  std::size_t within = 0;
  int distance = -1;
  while (static_cast<double>(within) < kLevelQuantile * static_cast<double>(count)) {
    within += distances[static_cast<std::size_t>(++distance)];
  }
  const int reach = 2 * distance + kLevelMargin;
  return reach <= kMaxLevelReach ? ImpulseRule{reach, kMinKnownDeviation} : ImpulseRule{};
}

struct ImpulseRules {
  ImpulseRule pepper;
  ImpulseRule salt;
};

// From the impulses that ImpulseFraction counts. Where flat regions show one kind only, as in snow or at night, the
// other has the same rule.
ImpulseRules FindImpulseRules(const cv::Mat& grey, const cv::Mat& median) {
  std::array<std::size_t, 256> pepper_distances{};
  std::array<std::size_t, 256> salt_distances{};
  VisitRows(grey, median, [&](int y, const NoiseRow& middle, const NoiseRow& around) {
    const uchar* const levels = grey.ptr(y);
    for (std::size_t x = 0; x < static_cast<std::size_t>(grey.cols); ++x) {
      const bool is_pepper = middle.below[x + 1] != 0;
      if (!is_pepper && middle.above[x + 1] == 0) continue;
      if (!IsFlat(around.highest[x], around.lowest[x])) continue;
      if (!IsIsolated(is_pepper ? around.below[x] : around.above[x])) continue;
      ++(is_pepper ? pepper_distances[levels[x]] : salt_distances[255U - levels[x]]);
    }
  });
  const std::optional<ImpulseRule> pepper = RuleFrom(pepper_distances);
  const std::optional<ImpulseRule> salt = RuleFrom(salt_distances);
  return {.pepper = pepper.value_or(salt.value_or(ImpulseRule{})),
          .salt = salt.value_or(pepper.value_or(ImpulseRule{}))};
}

// @param wider  5 x 5 median
void MarkImpulses(std::size_t count, const ImpulseRules& rules, const uchar* __restrict grey,
                  const uchar* __restrict median, const uchar* __restrict wider, uchar* __restrict marks) {
  const auto [pepper, salt] = rules;
  for (std::size_t x = 0; x < count; ++x) {
    const int below = median[x] - grey[x];
    const int wider_below = wider[x] - grey[x];
    const bool is_impulse =
        pepper.Matches(grey[x], below, wider_below) || salt.Matches(255 - grey[x], -below, -wider_below);
    marks[x] = is_impulse ? 255 : 0;
  }
}

// Mask: 255 at impulses. Their levels distinguish them from lines, leaves and print.
// @param median  3 x 3 median of `grey`
cv::Mat DetectImpulses(const cv::Mat& grey, const cv::Mat& median) {
  const ImpulseRules rules = FindImpulseRules(grey, median);
  cv::Mat wider;
  cv::medianBlur(grey, wider, 5);
  cv::Mat impulses(grey.size(), CV_8U);
  for (int y = 0; y < grey.rows; ++y) {
    MarkImpulses(static_cast<std::size_t>(grey.cols), rules, grey.ptr(y), median.ptr(y), wider.ptr(y), impulses.ptr(y));
  }
  return impulses;
}

// The mean of the nearest clean pixels, weighted by 1 / distance^2; the pixel itself if none is within kMaxReach.
uchar InterpolatePixel(const cv::Mat& grey, const cv::Mat& impulses, int x, int y) {
  for (int reach = 1; reach <= kMaxReach; ++reach) {
    float sum = 0;
    float weights = 0;
    for (int row = std::max(0, y - reach); row <= std::min(grey.rows - 1, y + reach); ++row) {
      for (int column = std::max(0, x - reach); column <= std::min(grey.cols - 1, x + reach); ++column) {
        if (impulses.at<uchar>(row, column) != 0) continue;
        const int distance2 = (row - y) * (row - y) + (column - x) * (column - x);
        const float weight = 1.0F / static_cast<float>(distance2);
        sum += weight * static_cast<float>(grey.at<uchar>(row, column));
        weights += weight;
      }
    }
    if (weights > 0) return cv::saturate_cast<uchar>(sum / weights);
  }
  return grey.at<uchar>(y, x);
}

}  // namespace

cv::Mat RemoveImpulses(const cv::Mat& grey, double min_fraction) {
  if (min_fraction >= 1 || std::min(grey.rows, grey.cols) < 5) return grey;
  cv::Mat median;
  cv::medianBlur(grey, median, 3);
  if (ImpulseFraction(grey, median) < min_fraction) return grey;
  const cv::Mat impulses = DetectImpulses(grey, median);
  cv::Mat clean = grey.clone();
  std::vector<cv::Point> pixels;
  cv::findNonZero(impulses, pixels);
  for (const cv::Point& pixel : pixels) clean.at<uchar>(pixel) = InterpolatePixel(grey, impulses, pixel.x, pixel.y);
  return clean;
}

}  // namespace victorious

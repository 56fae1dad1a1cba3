#include "victorious/input/image/grey_range.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include <fmt/format.h>

namespace victorious {
namespace {

constexpr double kTail = 0.005;            // fraction of pixels beyond each end of the used range
constexpr double kFewValues = 1.0 / 8;     // of white: below, fewer than 32 of 256 levels would be left
constexpr double kMaxClipped = 0.02;       // fraction of pixels
constexpr double kMargin = 0.5;            // of the used range, on each side
constexpr double kMinRange = 16;           // values: noise is not stretched to contrast
constexpr std::size_t kValues = 1U << 16;  // of a sample

std::vector<std::uint32_t> Histogram(const cv::Mat& image) {
  std::vector<std::uint32_t> counts(kValues);
  for (int y = 0; y < image.rows; ++y) {
    for (const std::uint16_t value : std::span(image.ptr<std::uint16_t>(y), static_cast<std::size_t>(image.cols))) {
      ++counts[value];
    }
  }
  return counts;
}

// The value below which this fraction of the pixels lies.
double Percentile(const std::vector<std::uint32_t>& counts, double total, double fraction) {
  double sum = 0;
  for (std::size_t value = 0; value < counts.size(); ++value) {
    sum += counts[value];
    if (sum > fraction * total) return static_cast<double>(value);
  }
  return static_cast<double>(counts.size() - 1);
}

double FractionOutside(const std::vector<std::uint32_t>& counts, double total, double low, double high) {
  double sum = 0;
  for (std::size_t value = 0; value < counts.size(); ++value) {
    const auto number = static_cast<double>(value);
    if (number < low || number > high) sum += counts[value];
  }
  return sum / total;
}

}  // namespace

cv::Mat GreyRange::ToEightBits(const cv::Mat& image, double white) {
  constexpr double kWhite = 255;
  cv::Mat grey;
  if (!image.empty() && (!is_decided_ || stretch_)) {
    const std::vector<std::uint32_t> counts = Histogram(image);
    const auto total = static_cast<double>(image.total());
    const Range used{Percentile(counts, total, kTail), Percentile(counts, total, 1 - kTail)};
    const double range = std::max(used.high - used.low, kMinRange);
    const Range wide{std::max(0.0, used.low - kMargin * range), std::min(white, used.high + kMargin * range)};
    if (!is_decided_) {
      is_decided_ = used.high - used.low >= kMinRange;  // not an image of one grey: a shutter, a film that fades in
      stretch_.reset();
      white_ = white;
      used_ = used;
      if (range < kFewValues * white) stretch_ = wide;
    } else if (stretch_ && FractionOutside(counts, total, stretch_->low, stretch_->high) > kMaxClipped) {
      stretch_ = Range{std::min(stretch_->low, wide.low), std::max(stretch_->high, wide.high)};
    }
  }
  const double low = stretch_ ? stretch_->low : 0;
  const double scale = kWhite / (stretch_ ? stretch_->high - stretch_->low : white);
  image.convertTo(grey, CV_8U, scale, -low * scale);
  return grey;
}

std::optional<std::string> GreyRange::Describe() const {
  if (!stretch_) return std::nullopt;
  return fmt::format("grey images with values of {:.0f} to {:.0f} of {:.0f}: they are stretched to full contrast",
                     used_->low, used_->high, white_);
}

}  // namespace victorious

// image/: grey images of more than 8 bits of which few values are used, as of thermal cameras (counts of 7200 to 8100):
//
//   grey = 255 (value - low) / (high - low)
//
// low and high lie beyond the values of the first image by half of their range, so that the images of one sequence have
// one scale. They widen where more values are clipped.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"
#include "victorious/input/image/image_file.h"

namespace victorious {

class GreyRange {
 public:
  /// Reduces an image (CV_16UC1) to CV_8UC1. The first image decides: if it uses an eighth of the values or more, all
  /// are scaled by `white` alone.
  /// @param white  the value that stands for white; zero stands for black
  [[nodiscard]] cv::Mat ToEightBits(const cv::Mat& image, double white);

  /// What was done, in one line; std::nullopt if all values are used.
  [[nodiscard]] std::optional<std::string> Describe() const;

 private:
  struct Range {
    double low = 0;
    double high = 0;
  };

  bool is_decided_ = false;
  double white_ = 0;
  std::optional<Range> used_;     ///< values of the first image
  std::optional<Range> stretch_;  ///< std::nullopt: by white alone
};

/// Decodes an image of a sequence with one range. Errors: those of ReadImage.
[[nodiscard]] Expected<Image> DecodeImage(std::span<const std::byte> bytes, const std::string& name, GreyRange& range);

}  // namespace victorious

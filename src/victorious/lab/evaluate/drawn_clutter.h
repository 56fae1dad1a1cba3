// Synthetic clutter: a background image without the object, for the detectability test of a model (detectability.h).
//
// Method: sum of noise octaves (wavelengths of 2 to 128 px, amplitude proportional to the square root of the
// wavelength, as natural ground), then random straight-edged rectangles, as a town has them. The image depends on its
// size and seed alone.
#pragma once

#include <cstdint>

#include <opencv2/core/mat.hpp>

namespace victorious {

/// Returns an image of `size`, CV_8UC1. Deterministic by `seed`.
[[nodiscard]] cv::Mat DrawClutter(cv::Size size, std::uint64_t seed);

}  // namespace victorious

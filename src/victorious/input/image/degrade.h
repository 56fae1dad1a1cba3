// Image degradation by optics and sensor, applied in physical order: Gaussian blur, Gaussian sensor noise, salt-and-
// pepper noise. Compression follows in the encoder.
#pragma once

#include <cstdint>

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"

namespace victorious {

struct DegradeOptions {
  double blur_px = 0;  ///< standard deviation of the Gaussian blur
  double grain = 0;    ///< standard deviation of Gaussian noise, independent per channel, grey levels (0 to 255)
  double noise = 0;    ///< salt-and-pepper noise: fraction of pixels set to white or black, half each; 0 to 1
};

/// @param seed  of the noise of this image
/// @param bgr   CV_8UC3, changed in place
void Degrade(const DegradeOptions& options, std::uint64_t seed, cv::Mat& bgr);

/// Image degradation: optics and sensor, then compression.
struct ImageDegradation {
  DegradeOptions degrade;
  int jpeg_quality = 0;  ///< 1 to 100; 0: no compression
};

/// Degrades an image (CV_8UC3) in place as a camera and an encoder do. Deterministic by `seed`.
[[nodiscard]] Status DegradeImage(const ImageDegradation& degradation, std::uint64_t seed, cv::Mat& bgr);

}  // namespace victorious

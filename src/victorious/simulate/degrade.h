// What optics and sensor do to a rendered picture, in the order light meets them: the lens blurs, the sensor adds
// noise to every pixel and loses some altogether. Compression comes after, in the encoder.
#pragma once

#include <cstdint>

#include <opencv2/core/mat.hpp>

namespace victorious {

struct DegradeOptions {
  double blur_px = 0;  ///< sigma of the Gaussian blur
  double grain = 0;    ///< sigma of Gaussian noise, of each channel by itself, grey levels of 255
  double noise = 0;    ///< share of pixels turned to white or black (salt and pepper), half each; 0 to 1
};

/// @param bgr   CV_8UC3, changed in place
/// @param seed  of this picture's noise
void Degrade(const DegradeOptions& options, std::uint64_t seed, cv::Mat& bgr);

}  // namespace victorious

// A background in which nothing is to be found: ground of all scales, strewn with straight-edged things, as a town has
// them. By its seed alone, so that a model can be tried before there is a video.
#pragma once

#include <cstdint>

#include <opencv2/core/mat.hpp>

namespace victorious {

/// CV_8UC1.
[[nodiscard]] cv::Mat DrawClutter(cv::Size size, std::uint64_t seed);

}  // namespace victorious

// A synthetic aerial image of a town, generated from a seed: streets with markings, roofs, gardens, trees and parked
// cars, with detail down to one pixel and texture at all larger scales.
#pragma once

#include <cstdint>

#include <opencv2/core.hpp>

namespace victorious::testing {

/// Returns a CV_8UC3 image. A car is about 84 px long, a house 180 px, a block of houses 500 px.
cv::Mat DrawTown(cv::Size size, std::uint64_t seed);

}  // namespace victorious::testing

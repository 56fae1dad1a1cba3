// A toy town from the air, drawn by seed: streets with their markings, roofs, gardens, trees and parked cars, sharp at
// one pixel and with texture at every scale above it.
#pragma once

#include <cstdint>

#include <opencv2/core.hpp>

namespace victorious::testing {

/// CV_8UC3. A car is about 84 px long, a house 180, a block of houses 500.
cv::Mat DrawTown(cv::Size size, std::uint64_t seed);

}  // namespace victorious::testing

// Synthetic planar objects to search for, generated from a seed: rich in corners, and distinguishable by seed.
#pragma once

#include <cstdint>
#include <string_view>

#include <opencv2/core.hpp>

#include "victorious/geometry/polygon.h"

namespace victorious::testing {

/// All drawn as seen from nadir.
enum class ObjectKind {
  kCrate,     ///< a stencilled crate, 176 x 176 px
  kTruck,     ///< a loaded truck, 120 x 200 px, with mirrors
  kSign,      ///< a signboard lying on its back, 192 x 136 px
  kAircraft,  ///< a light aircraft, 200 x 184 px, far from a rectangle
};
inline constexpr int kNumObjectKinds = 4;

/// "crate", "truck", "sign", "aircraft".
std::string_view Name(ObjectKind kind);

struct SyntheticObject {
  cv::Mat image;    ///< CV_8UC4, BGRA, alpha not premultiplied
  Polygon outline;  ///< of the opaque pixels, px
};

SyntheticObject DrawObject(ObjectKind kind, std::uint64_t seed);

}  // namespace victorious::testing

// Flat things to look for, drawn by seed: rich in corners, and different seeds give things that can be told apart.
#pragma once

#include <cstdint>
#include <string_view>

#include <opencv2/core.hpp>

#include "victorious/geometry/polygon.h"

namespace victorious::testing {

/// All seen from straight above.
enum class ThingKind {
  kCrate,     ///< a stencilled crate, 176 x 176 px
  kTruck,     ///< a loaded truck, 120 x 200 px, with mirrors
  kSign,      ///< a signboard lying on its back, 192 x 136 px
  kAircraft,  ///< a light aircraft, 200 x 184 px, far from a rectangle
};
inline constexpr int kThingKinds = 4;

/// "crate", "truck", "sign", "aircraft".
std::string_view Name(ThingKind kind);

struct DrawnThing {
  cv::Mat picture;  ///< CV_8UC4, BGRA, alpha not premultiplied
  Polygon outline;  ///< of what is opaque, px
};

DrawnThing DrawThing(ThingKind kind, std::uint64_t seed);

}  // namespace victorious::testing

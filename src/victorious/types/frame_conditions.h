// What is known of a frame before its features are looked at: how the camera was held, where the sun stood.
#pragma once

#include <optional>

#include "victorious/geometry/sun.h"
#include "victorious/geometry/vertical.h"

namespace victorious {

struct FrameConditions {
  std::optional<Vertical> vertical;
  /// Its azimuth clockwise from that of the line of sight through the image's middle; only together with `vertical`.
  std::optional<Sun> sun_ahead;
};

}  // namespace victorious

// Priors of a frame that do not depend on its features: the vertical in the camera frame and the sun's direction.
#pragma once

#include <optional>

#include "victorious/geometry/sun.h"
#include "victorious/geometry/vertical.h"

namespace victorious {

struct FrameConditions {
  std::optional<Vertical> vertical;  ///< from the camera's attitude; nullopt: unknown
  /// The sun; its azimuth is measured clockwise from the azimuth of the line of sight through the image centre. Set
  /// only together with `vertical`.
  std::optional<Sun> relative_sun;
  /// Height of the camera above the ground in the middle of the image, m: of the ground given, or of the estimate
  /// (place/calibrate/ground_height.h); nullopt: unknown.
  std::optional<double> height_above_ground_m = {};
};

}  // namespace victorious

// The motion of a place over the ground.
#pragma once

#include <optional>

#include "victorious/types/geolocation.h"

namespace victorious {

/// The direction of motion over the ground, with standard deviations to first order.
struct GroundMotion {
  double speed_m_s = 0;
  double sigma_speed_m_s = 0;
  double course_rad = 0;  ///< clockwise from north, [0, 2 pi)
  double sigma_course_rad = 0;
};

/// std::nullopt if the place does not move, or the error of its motion is unknown.
[[nodiscard]] std::optional<GroundMotion> ComputeGroundMotion(const Geolocation& place);

}  // namespace victorious

#include "victorious/types/ground_motion.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

#include "victorious/geometry/angles.h"

namespace victorious {

std::optional<GroundMotion> ComputeGroundMotion(const Geolocation& place) {
  if (!place.IsMoving() || !place.velocity_covariance_enu) return std::nullopt;
  const Eigen::Vector2d velocity = place.velocity_enu->head<2>();
  const double speed_m_s = velocity.norm();
  if (!(speed_m_s > 0)) return std::nullopt;
  const Eigen::Matrix2d covariance = place.velocity_covariance_enu->topLeftCorner<2, 2>();
  const Eigen::Vector2d along = velocity / speed_m_s;
  const Eigen::Vector2d across(along.y(), -along.x());
  const double course_rad = std::atan2(velocity.x(), velocity.y());
  return GroundMotion{.speed_m_s = speed_m_s,
                      .sigma_speed_m_s = std::sqrt(along.dot(covariance * along)),
                      .course_rad = course_rad < 0 ? course_rad + 2 * kPi : course_rad,
                      .sigma_course_rad = std::min(kPi, std::sqrt(across.dot(covariance * across)) / speed_m_s)};
}

}  // namespace victorious

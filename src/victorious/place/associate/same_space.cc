#include "victorious/place/associate/same_space.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

#include "victorious/geometry/angles.h"
#include "victorious/place/associate/object_options.h"
#include "victorious/types/line_direction.h"

namespace victorious {
namespace {

// Below it, what the ground is higher under one than under the other moves p2 by more than its width. Chosen.
constexpr double kMinDepression_rad = RadiansFromDegrees(20);
// Larger differences between the range of the second and that of p2 mean that it is at another height.
constexpr double kMaxRangeSigmas = 3;
// Centre lines at a smaller angle are parallel. Chosen: beyond the error of headings.
constexpr double kMaxTurn_rad = RadiansFromDegrees(30);
// Objects seen at a larger angle to their centre line are seen from the side. Chosen.
constexpr double kMinSideAngle_rad = RadiansFromDegrees(45);
// Of the smaller box. The boxes of two vehicles in a row, seen from the side, overlap by less: 0.05 for two lorries a
// metre apart at kMinSideAngle_rad.
constexpr double kMinBoxOverlap = 0.2;

double OverlapOfSmaller(const Box& a, const Box& b) {
  const double smaller = std::min(a.Area(), b.Area());
  return smaller > 0 ? Intersection(a, b).Area() / smaller : 0;
}

}  // namespace

bool AreInSameSpace(const BearingObservation& first, const Box& first_box, const BearingObservation& second,
                    const Box& second_box) {
  if (!first.line.range_m || !second.line.range_m || !first.heading_rad || !second.heading_rad) return false;
  if (std::max(first.line.elevation_rad, second.line.elevation_rad) > -kMinDepression_rad) return false;
  const Eigen::Vector3d first_m = *first.line.range_m * DirectionOf(first.line);
  const Eigen::Vector3d direction = DirectionOf(second.line);
  const double range_m = first_m.z() / direction.z();
  const double sigma_m = std::hypot(first.line.sigma_range_m.value_or(0), second.line.sigma_range_m.value_or(0));
  if (std::abs(*second.line.range_m - range_m) > kMaxRangeSigmas * sigma_m) return false;

  const Eigen::Vector3d apart_m = range_m * direction - first_m;
  if (apart_m.norm() < kMinSeparation_m) return true;
  // Of lines without a sense.
  const double turn_rad = std::remainder(*second.heading_rad - *first.heading_rad, kPi);
  if (std::abs(turn_rad) > kMaxTurn_rad) return false;
  const double heading_rad = *first.heading_rad + turn_rad / 2;
  const double side_rad = std::abs(std::remainder(first.line.azimuth_rad - heading_rad, kPi));
  const double right_m = apart_m.x() * std::cos(heading_rad) - apart_m.y() * std::sin(heading_rad);
  return std::abs(right_m) < kMinSeparation_m && side_rad > kMinSideAngle_rad &&
         OverlapOfSmaller(first_box, second_box) >= kMinBoxOverlap;
}

}  // namespace victorious

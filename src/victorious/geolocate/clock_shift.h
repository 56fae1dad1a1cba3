// The error of a place by an error of telemetry's clock, which all lines of sight of a flight share:
//
//   d = argmin_d sum_i |W_i^(1/2) (d - s_i)|^2,   W_i = (I - (1 - w) f_i f_i') / distance_i^2
//
// is the shift of the place if every line shifts by s_i at the object; f_i is the line's direction, and w = 0.01 stands
// for what fixes the distance where lines are parallel. An object on given ground stays on it. d is added to the
// covariance as d d', one term for each flight. The place itself does not change: lines of sight hardly contradict a
// wrong clock, or its offset would be known by the motion of the image.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "victorious/types/geolocation.h"
#include "victorious/types/line_of_sight.h"

namespace victorious {

/// The shift of the line at this distance, east-north-up, m, by one standard deviation of its clock. Zero without one.
[[nodiscard]] Eigen::Vector3d ClockShiftAt(const LineOfSight& line, double distance_m);

/// Adds the errors of the clocks to the covariances of place and velocity, and to CE90 and LE90.
/// @param lines      that determine the place
/// @param inliers    one per line; the others do not count
/// @param on_ground  the object stands on given ground
void AddClockError(std::span<const LineOfSight> lines, const std::vector<bool>& inliers, bool on_ground,
                   Geolocation& place);

/// The same for each place of a path, by the lines within 2 s.
/// @param lines  in order of time
void AddClockError(std::span<const LineOfSight> lines, const std::vector<bool>& inliers, bool on_ground,
                   std::span<Geolocation> path);

}  // namespace victorious

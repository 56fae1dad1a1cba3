// The error of a place by errors of telemetry that are common to all lines of sight of a flight: of its clock, and of
// its field of view. For each,
//
//   d = argmin_d sum_i |W_i^(1/2) (d - s_i)|^2,   W_i = (I - (1 - w) f_i f_i') / distance_i^2
//
// is the shift of the place if every line shifts by s_i at the object; f_i is the line's direction, and w = 0.01 stands
// for what fixes the distance where lines are parallel. An object on given ground stays on it. d is added to the
// covariance as d d', one term for each error. The place itself does not change: lines of sight hardly
// contradict a wrong clock, or its offset would be known by the motion of the image. The same holds for the field of
// view where the camera flies straight.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "victorious/types/geolocation.h"
#include "victorious/types/line_of_sight.h"

namespace victorious {

/// The shift of the line at this distance, east-north-up, m, by one standard deviation of its clock. Zero without one.
[[nodiscard]] Eigen::Vector3d ClockShiftAt(const LineOfSight& line, double distance_m);

/// The same by one standard deviation of its focal length. A line without a range turns only.
[[nodiscard]] Eigen::Vector3d FocalShiftAt(const LineOfSight& line, double distance_m);

/// Adds the errors of the flight to the covariances of place and velocity, and to CE90 and LE90.
/// @param lines      of one flight, that determine the place
/// @param inliers    one per line; the others do not count
/// @param on_ground  the object stands on given ground
void AddFlightErrors(std::span<const LineOfSight> lines, const std::vector<bool>& inliers, bool on_ground,
                     Geolocation& place);

/// The same for each place of a path, by the lines within 2 s.
/// @param lines  in order of time
void AddFlightErrors(std::span<const LineOfSight> lines, const std::vector<bool>& inliers, bool on_ground,
                     std::span<Geolocation> path);

}  // namespace victorious

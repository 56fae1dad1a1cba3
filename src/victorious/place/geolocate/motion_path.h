// Estimates the path of an object whose lines of sight have accurate ranges: whether it moves, and its place and
// velocity at the time of each line.
//
// A range fixes the distance in each frame, so that the path is determined also where lines alone are not: if camera
// and object both move straight, any scale of the path fits the lines. Method: path_smoother.h. The object moves if a
// path explains lines and ranges better than a place does, by the Bayesian information criterion (Schwarz 1978) over
// truncated squared residuals and the squared common errors: a place 1.9 times as far as the ranges say needs a common
// range error of many sigmas. Successive residuals are correlated; the difference is divided by their correlation time.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "victorious/place/geolocate/locate_options.h"
#include "victorious/types/geolocation.h"
#include "victorious/types/line_of_sight.h"

namespace victorious {

struct MotionPath {
  bool is_moving = false;           ///< false: a static object; it has no places here
  std::vector<Geolocation> places;  ///< with velocities, in order of time; one per line, or fewer if there are many
  std::vector<bool> inliers;        ///< one per line: within the gate or the identity radius of it
  double acceleration_m_s2 = 0;     ///< median magnitude over half a second
};

/// Estimates the path. std::nullopt if the lines do not determine it: fewer than three, or one without a range.
/// @param lines    in order of time
/// @param options  as for Locate; `motion` kVelocity skips the comparison with a static object
/// Cost: some 0.3 ms per line, for at most 1000 lines.
std::optional<MotionPath> EstimatePath(std::span<const LineOfSight> lines, const LocateOptions& options);

}  // namespace victorious

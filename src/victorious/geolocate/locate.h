// Lines of sight in, a place on Earth with its covariance out.
//
// Thesis, section 4.3.3: an object at o, moving with v, is seen at time t_i from camera r_i along the unit vector s_i:
//   o + v t_i = r_i + a_i s_i,   a_i > 0
// The estimators, by name of the method:
//   least-squares  the point nearest to all lines; eliminating the a_i leaves a system of 3 x 3, or 6 x 6 with velocity
//   prior          the same with the ranges known from apparent size; a line whose conic frustum the solution would
//                  leave is set aside
//   ransac         the place in most lines' frusta, then as `prior` over those
//   ground         the mean of where the lines meet the ground, for comparison
//   ml             from ransac's place, the most likely one: every line's own errors, Huber's loss, and the errors
//                  common to the flight as unknowns with priors, so that many lines do not feign a small ellipse
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/geolocate/locate_options.h"
#include "victorious/types/line_of_sight.h"
#include "victorious/types/place.h"

namespace victorious {

struct GeoFix {
  std::optional<Place> place;  ///< none where the lines do not determine one
  std::vector<bool> inliers;   ///< one a line
  std::string status;          ///< "ok", or why there is no place
};

/// Lines in any order. Too few lines, parallel lines, a point behind the camera are results with a status, not errors.
/// Errors: kInvalidArgument for options out of range, no lines, or the method `ground` without a ground height.
/// Cost: ml, ransac, least-squares, ground linear in the lines; prior at worst quadratic.
Expected<GeoFix> Locate(std::span<const LineOfSight> lines, const LocateOptions& options);

}  // namespace victorious

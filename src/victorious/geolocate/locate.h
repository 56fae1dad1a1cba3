// Geolocation: estimates the place of an object on Earth, with covariance, from lines of sight. Called with the bearing
// observations of an object by associate/object_place.cc, and with a CSV file by `victorious locate`.
//
// Measurement model (thesis, section 4.3.3): an object at o with velocity v is observed at time t_i by a camera at r_i
// along the unit vector s_i:
//   o + v t_i = r_i + a_i s_i,   a_i > 0
// The estimators, by the name of the method:
//   least-squares  the point nearest to all lines; eliminating the a_i leaves a system of 3 x 3, or 6 x 6 with velocity
//   prior          the same with ranges from apparent size; rejects a line if the solution would leave its conic
//   frustum ransac         the place in the frusta of the largest number of lines, then as `prior` over these inliers
//   ground         the mean of the intersections of the lines with the ground; a baseline for comparison
//   ml             maximum likelihood, started from ransac's place: each line's own errors, Huber's loss, and the
//   errors
//                  common to the flight as unknowns with priors, so that many lines do not yield too small an ellipse
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/geolocate/locate_options.h"
#include "victorious/types/geolocation.h"
#include "victorious/types/line_of_sight.h"

namespace victorious {

struct GeoFix {
  std::optional<Geolocation> place;  ///< std::nullopt if the lines do not determine a place
  std::vector<bool> inliers;         ///< one per line
  std::string status;                ///< "ok", or the reason why there is no place
};

/// Estimates the place; the lines may be in any order. Too few lines, parallel lines or an intersection behind the
/// camera give a result with a status, not an error. Errors: kInvalidArgument for options out of range, no lines, or
/// the method `ground` without a ground. Cost: linear in the number of lines for ml, ransac, least-squares and ground;
/// at worst quadratic for prior.
Expected<GeoFix> Locate(std::span<const LineOfSight> lines, const LocateOptions& options);

}  // namespace victorious

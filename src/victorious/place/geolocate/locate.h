// Geolocation: estimates the place of an object on Earth, with covariance, from lines of sight. Called with the bearing
// observations of an object by place/associate/object_place.cc, and with a CSV file by `victorious locate`.
//
// Measurement model (thesis, section 4.3.3): an object at o with velocity v is observed at time t_i by a camera at r_i
// along the unit vector s_i:
//   o + v t_i = r_i + a_i s_i,   a_i > 0
// The estimators (LocateMethod), by name:
//   - least-squares: the point nearest to all lines; eliminating the a_i leaves a system of 3 x 3, or 6 x 6 with
//     velocity.
//   - prior: the same with ranges from apparent size; rejects a line if the solution would leave its conic frustum.
//   - ransac: the place in the frusta of the largest number of lines, then as `prior` over these inliers.
//   - ground: the mean of the intersections of the lines with the ground; a baseline for comparison.
//   - ml: maximum likelihood, started from ransac's place: each line's own errors, Huber's loss, and the errors common
//     to the flight as unknowns with priors, so that many lines do not yield too small an ellipse.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/place/geolocate/locate_options.h"
#include "victorious/types/geolocation.h"
#include "victorious/types/line_of_sight.h"

namespace victorious {

/// Maximum standard deviation of a place along any axis, as a fraction of its distance; a less certain place is not
/// reported: at twice this it might as well be at the camera or at twice the distance.
inline constexpr double kMaxErrorFraction = 0.5;

/// Why there is a place, or none. The texts are in locate.cc.
enum class LocateStatus {
  kOk,
  kCameraBelowGround,     ///< the given ground is above the cameras
  kOffTerrain,            ///< the lines leave the given terrain, or meet it where it has no height
  kMissesGround,          ///< no line intersects the given ground
  kSingleLineVelocity,    ///< one line does not determine a velocity
  kSingleLineRange,       ///< one line without a range, and no ground
  kTooFewForVelocity,     ///< too few lines, or too parallel, for a place and a velocity
  kParallel,              ///< no intersection
  kBehindCamera,          ///< the intersection is behind the camera
  kInconsistent,          ///< no place within the errors of the lines
  kDistanceUnobservable,  ///< the lines differ too little, for their errors, to determine the distance
  kTooUncertain,          ///< a standard deviation above kMaxErrorFraction of the distance
};

struct GeoFix {
  std::optional<Geolocation> place;  ///< std::nullopt if the lines do not determine a place
  std::vector<bool> inliers;         ///< one per line
  LocateStatus status = LocateStatus::kOk;
  double rejected_sigma_m = 0;     ///< kTooUncertain: the largest standard deviation of the rejected place, and
  double rejected_distance_m = 0;  ///< its distance
};

/// Returns the status as text: "ok", or the reason why there is no place.
std::string StatusText(const GeoFix& fix);

/// Estimates the place; the lines may be in any order. Too few lines, parallel lines or an intersection behind the
/// camera give a result with a status, not an error. Errors: kInvalidArgument for options out of range, no lines, or
/// the method `ground` without a ground. Cost: linear in the number of lines for ml, ransac, least-squares and ground;
/// at worst quadratic for prior.
[[nodiscard]] Expected<GeoFix> Locate(std::span<const LineOfSight> lines, const LocateOptions& options);

/// As Locate, for lines and options that the caller has checked: at least one line, options that pass ValidateOptions,
/// and a ground for the method `ground`. Then there is no error.
GeoFix LocateChecked(std::span<const LineOfSight> lines, const LocateOptions& options);

}  // namespace victorious

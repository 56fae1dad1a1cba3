// Errors of reported object places against ground truth, and the coverage of their uncertainty.
//
// Method: the error vector e = (east, north, up) is taken in the tangent plane at the true place. The 90 % ellipsoid
// test is the chi-square gate e^T C^-1 e <= 6.251 (3 degrees of freedom).
#pragma once

#include <optional>
#include <vector>

#include "victorious/lab/evaluate/truth.h"
#include "victorious/types/geolocation.h"

namespace victorious {

/// Errors of one reported object against the truth row nearest to the time of its place.
struct PlaceError {
  std::optional<double> horizontal_error_m;  ///< horizontal error
  std::optional<double> spatial_error_m;     ///< 3-D error
  bool in_ellipsoid = false;                 ///< the truth lies in the 90 % ellipsoid; false for a singular covariance
  bool in_ce90 = false;                      ///< the horizontal error is at most CE90
  std::optional<double> heading_rad;         ///< absolute heading error, 0 to pi
};

/// Computes the errors. A field is std::nullopt (a bool: false) if either side of its comparison is unknown.
PlaceError ComputePlaceError(const std::optional<Geolocation>& place, const std::optional<double>& heading_rad,
                             const TruthRow& truth);

}  // namespace victorious

// How far reported places are from the true ones.
#pragma once

#include <optional>
#include <vector>

#include "victorious/evaluate/truth.h"
#include "victorious/types/place.h"

namespace victorious {

/// One reported object beside the truth at the time of its place.
struct PlaceError {
  std::optional<double> across_m;     ///< along the ground
  std::optional<double> all_m;        ///< in space
  bool in_ellipsoid = false;          ///< the truth is in the 90 % ellipsoid of the covariance
  bool in_ce90 = false;               ///< and within CE90 along the ground
  std::optional<double> heading_rad;  ///< 0 to pi
};

/// What differs where either side is not known is not there.
PlaceError ComparePlaces(const std::optional<Place>& place, const std::optional<double>& heading_rad,
                         const TruthRow& truth);

}  // namespace victorious

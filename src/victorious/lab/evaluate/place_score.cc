#include "victorious/lab/evaluate/place_score.h"

#include <cmath>

#include <Eigen/Cholesky>

#include "victorious/geometry/angles.h"

namespace victorious {

PlaceError ComputePlaceError(const std::optional<Geolocation>& place, const std::optional<double>& heading_rad,
                             const TruthRow& truth) {
  PlaceError error;
  if (heading_rad && truth.heading_rad) error.heading_rad = std::abs(WrapAngle(*heading_rad - *truth.heading_rad));
  if (!place || !truth.place) return error;
  const Eigen::Vector3d error_enu_m = TangentPlane(*truth.place).EnuFromGeodetic(place->point);
  error.horizontal_error_m = error_enu_m.head<2>().norm();
  error.spatial_error_m = error_enu_m.norm();
  error.in_ce90 = *error.horizontal_error_m <= place->ce90_m;
  constexpr double kChiSquare90 = 6.251;  // quantile of chi-square with three degrees of freedom
  const Eigen::LLT<Eigen::Matrix3d> covariance(place->covariance_enu_m2);
  error.in_ellipsoid =
      covariance.info() == Eigen::Success && error_enu_m.dot(covariance.solve(error_enu_m)) <= kChiSquare90;
  return error;
}

}  // namespace victorious

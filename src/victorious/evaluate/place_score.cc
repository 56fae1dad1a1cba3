#include "victorious/evaluate/place_score.h"

#include <cmath>

#include <Eigen/Cholesky>

#include "victorious/geometry/angles.h"

namespace victorious {

PlaceError ComparePlaces(const std::optional<Place>& place, const std::optional<double>& heading_rad,
                         const TruthRow& truth) {
  PlaceError error;
  if (heading_rad && truth.heading_rad) error.heading_rad = std::abs(WrapAngle(*heading_rad - *truth.heading_rad));
  if (!place || !truth.place) return error;
  const Eigen::Vector3d off = TangentPlane(*truth.place).EnuFromGeodetic(place->point);
  error.across_m = off.head<2>().norm();
  error.all_m = off.norm();
  error.in_ce90 = *error.across_m <= place->ce90_m;
  constexpr double kNinetyPercent = 6.251;  // quantile of chi-square with three degrees of freedom
  const Eigen::LLT<Eigen::Matrix3d> covariance(place->covariance_enu_m2);
  error.in_ellipsoid = covariance.info() == Eigen::Success && off.dot(covariance.solve(off)) <= kNinetyPercent;
  return error;
}

}  // namespace victorious

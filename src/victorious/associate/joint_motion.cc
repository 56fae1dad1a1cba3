#include "victorious/associate/joint_motion.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "victorious/associate/object_options.h"
#include "victorious/geolocate/error_ellipse.h"

namespace victorious {
namespace {

// Standard deviation of the difference of two flights' clocks, s, while they state UTC. Chosen: receivers of GPS agree
// to milliseconds, but recorders stamp a frame up to some frames late.
constexpr double kUtcSigma_s = 0.1;

// The errors that all places of the flight share.
Eigen::Matrix3d CommonCovariance(const ObjectInFlight& flight) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(flight.absolute.covariance_enu_m2 -
                                                              flight.relative.place->covariance_enu_m2);
  return solver.eigenvectors() * solver.eigenvalues().cwiseMax(0).asDiagonal() * solver.eigenvectors().transpose();
}

Geolocation PlaceAtUtc(const ObjectInFlight& flight, double utc_s) {
  return PlaceAt(flight.relative, utc_s - flight.utc_offset_s);
}

// From the place by `a` to the place by `b` at one time, and its covariance without the errors that the flights share.
struct Difference {
  Eigen::Vector3d enu_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance_m2 = Eigen::Matrix3d::Zero();
};

Difference DifferenceAt(const ObjectInFlight& a, const ObjectInFlight& b, double utc_s) {
  const Geolocation of_a = PlaceAtUtc(a, utc_s);
  const Geolocation of_b = PlaceAtUtc(b, utc_s);
  Difference difference{.enu_m = TangentPlane(of_a.point).EnuFromGeodetic(of_b.point),
                        .covariance_m2 = of_a.covariance_enu_m2 + of_b.covariance_enu_m2};
  const Eigen::Vector3d velocity = of_a.velocity_enu.value_or(of_b.velocity_enu.value_or(Eigen::Vector3d::Zero()));
  difference.covariance_m2 += kUtcSigma_s * kUtcSigma_s * velocity * velocity.transpose();
  return difference;
}

double Sigmas(const Eigen::Vector3d& difference, const Eigen::Matrix3d& covariance) {
  return std::sqrt(difference.dot(covariance.ldlt().solve(difference)));
}

// The beginning and the end of the time in which both flights see the object; both the middle between, if there is no
// such time.
std::pair<double, double> CommonTime(const ObjectInFlight& a, const ObjectInFlight& b) {
  const double begin_s = std::max(a.first_s, b.first_s);
  const double end_s = std::min(a.last_s, b.last_s);
  if (begin_s <= end_s) return {begin_s, end_s};
  return {(begin_s + end_s) / 2, (begin_s + end_s) / 2};
}

}  // namespace

std::optional<HypothesisDistance> CompareFlights(const ObjectInFlight& a, const ObjectInFlight& b) {
  if (std::max(a.first_s, b.first_s) - std::min(a.last_s, b.last_s) > kMaxFlightGap_s) return std::nullopt;
  const auto [begin_s, end_s] = CommonTime(a, b);
  const Eigen::Matrix3d slack_m2 = 2 * kMergeSlack_m * kMergeSlack_m * Eigen::Matrix3d::Identity();
  const Difference middle = DifferenceAt(a, b, (begin_s + end_s) / 2);
  const Difference first = DifferenceAt(a, b, begin_s);
  const Difference last = DifferenceAt(a, b, end_s);
  const double of_place =
      Sigmas(middle.enu_m, middle.covariance_m2 + CommonCovariance(a) + CommonCovariance(b) + slack_m2);
  const double of_change = Sigmas(last.enu_m - first.enu_m, first.covariance_m2 + last.covariance_m2 + 2 * slack_m2);
  return HypothesisDistance{.metres = middle.enu_m.norm(), .sigmas = std::max(of_place, of_change)};
}

ObjectPlace FuseFlights(std::span<const ObjectInFlight> flights) {
  const ObjectInFlight& last = *std::ranges::max_element(flights, {}, &ObjectInFlight::last_s);
  Eigen::Matrix3d common_m2 = CommonCovariance(last);
  Eigen::Vector3d correction = Eigen::Vector3d::Zero();
  ObjectPlace fused{.place = last.relative.place, .path = {}, .heading_rad = last.relative.heading_rad};
  double observations = 0;
  for (const ObjectInFlight& flight : flights) {
    observations += flight.observations;
    fused.inlier_fraction += flight.observations * flight.relative.inlier_fraction;
    fused.consistent_fraction += flight.observations * flight.relative.consistent_fraction;
    fused.headings += flight.relative.headings;
    fused.contradicting_headings += flight.relative.contradicting_headings;
    if (&flight == &last) continue;
    const Difference difference = DifferenceAt(last, flight, CommonTime(last, flight).second);
    const Eigen::Matrix3d innovation_m2 = common_m2 + CommonCovariance(flight) + difference.covariance_m2;
    const Eigen::Matrix3d gain = innovation_m2.ldlt().solve(common_m2).transpose();
    correction += gain * (difference.enu_m - correction);
    common_m2 -= gain * common_m2;
  }
  if (observations > 0) {
    fused.inlier_fraction /= observations;
    fused.consistent_fraction /= observations;
  }
  Geolocation& place = *fused.place;
  place.point = TangentPlane(place.point).GeodeticFromEnu(correction);
  place.covariance_enu_m2 += (common_m2 + common_m2.transpose()) / 2;
  SetErrorRadii(place);
  return fused;
}

}  // namespace victorious

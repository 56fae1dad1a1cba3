#include "victorious/place/associate/flight_fusion.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "victorious/place/associate/object_options.h"
#include "victorious/place/geolocate/error_ellipse.h"

namespace victorious {
namespace {

// Standard deviation of the difference of two flights' clocks, s, while they state UTC. Chosen: receivers of GPS agree
// to milliseconds, but recorders stamp a frame up to some frames late.
constexpr double kUtcSigma_s = 0.1;

Geolocation PlaceAtUtc(const ObjectInFlight& flight, double utc_s) {
  return PlaceAt(flight.relative, utc_s - *flight.utc_offset_s);
}

FlightOffset OffsetBetween(const Geolocation& of_a, const Geolocation& of_b) {
  return {.enu_m = TangentPlane(of_a.point).EnuFromGeodetic(of_b.point),
          .covariance_m2 = of_a.covariance_enu_m2 + of_b.covariance_enu_m2};
}

FlightOffset OffsetAt(const ObjectInFlight& a, const ObjectInFlight& b, double utc_s) {
  const Geolocation of_a = PlaceAtUtc(a, utc_s);
  const Geolocation of_b = PlaceAtUtc(b, utc_s);
  FlightOffset offset = OffsetBetween(of_a, of_b);
  const Eigen::Vector3d velocity = of_a.velocity_enu.value_or(of_b.velocity_enu.value_or(Eigen::Vector3d::Zero()));
  offset.covariance_m2 += kUtcSigma_s * kUtcSigma_s * velocity * velocity.transpose();
  return offset;
}

// The beginning and the end of the time in which both flights see the object; both the middle between, if there is no
// such time.
std::pair<double, double> CommonTime(const ObjectInFlight& a, const ObjectInFlight& b) {
  const double begin_s = std::max(a.first_s, b.first_s);
  const double end_s = std::min(a.last_s, b.last_s);
  if (begin_s <= end_s) return {begin_s, end_s};
  return {(begin_s + end_s) / 2, (begin_s + end_s) / 2};
}

PlaceDifference CompareStatic(const ObjectInFlight& a, const ObjectInFlight& b) {
  PlaceDifference difference{.offset = OffsetBetween(*a.relative.place, *b.relative.place)};
  difference.offset.covariance_m2 += MergeSlackCovariance();
  return difference;
}

std::optional<PlaceDifference> CompareMoving(const ObjectInFlight& a, const ObjectInFlight& b) {
  if (!a.utc_offset_s || !b.utc_offset_s) return std::nullopt;
  if (std::max(a.first_s, b.first_s) - std::min(a.last_s, b.last_s) > kMaxFlightGap_s) return std::nullopt;
  const auto [begin_s, end_s] = CommonTime(a, b);
  PlaceDifference difference{.offset = OffsetAt(a, b, (begin_s + end_s) / 2)};
  difference.offset.covariance_m2 += MergeSlackCovariance();
  const FlightOffset first = OffsetAt(a, b, begin_s);
  const FlightOffset last = OffsetAt(a, b, end_s);
  difference.change_sigmas =
      Mahalanobis(last.enu_m - first.enu_m, first.covariance_m2 + last.covariance_m2 + 2 * MergeSlackCovariance());
  return difference;
}

const ObjectInFlight& LastOf(std::span<const ObjectInFlight* const> flights) {
  return **std::ranges::max_element(flights, {}, [](const ObjectInFlight* flight) { return flight->last_s; });
}

const ObjectInFlight& BestHeadingOf(std::span<const ObjectInFlight* const> flights) {
  return **std::ranges::max_element(flights, {},
                                    [](const ObjectInFlight* flight) { return flight->relative.headings; });
}

Geolocation FuseMoving(std::span<const ObjectInFlight* const> flights) {
  const ObjectInFlight& last = LastOf(flights);
  Eigen::Matrix3d common_m2 = last.common_m2;
  Eigen::Vector3d correction = Eigen::Vector3d::Zero();
  for (const ObjectInFlight* flight : flights) {
    if (flight == &last) continue;
    const FlightOffset offset = OffsetAt(last, *flight, CommonTime(last, *flight).second);
    const Eigen::Matrix3d innovation_m2 = common_m2 + flight->common_m2 + offset.covariance_m2;
    const Eigen::Matrix3d gain = innovation_m2.ldlt().solve(common_m2).transpose();
    correction += gain * (offset.enu_m - correction);
    common_m2 -= gain * common_m2;
  }
  Geolocation place = *last.relative.place;
  place.point = TangentPlane(place.point).GeodeticFromEnu(correction);
  place.covariance_enu_m2 += (common_m2 + common_m2.transpose()) / 2;
  return place;
}

// The mean of the flights that have one, weighted by their observations.
void FuseSizeRatios(std::span<const ObjectInFlight* const> flights, ObjectPlace& fused) {
  double sum = 0;
  double sigmas = 0;
  double observations = 0;
  for (const ObjectInFlight* flight : flights) {
    if (!flight->relative.size_ratio) continue;
    sum += flight->observations * std::log(*flight->relative.size_ratio);
    sigmas += flight->observations * flight->relative.size_sigma;
    observations += flight->observations;
  }
  if (!(observations > 0)) return;
  fused.size_ratio = std::exp(sum / observations);
  fused.size_sigma = sigmas / observations;
}

}  // namespace

void ObjectInFlight::SetPlaces(ObjectPlace within_flight, const Geolocation& with_all_errors) {
  relative = std::move(within_flight);
  absolute = with_all_errors;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(absolute.covariance_enu_m2 -
                                                              relative.place->covariance_enu_m2);
  common_m2 = solver.eigenvectors() * solver.eigenvalues().cwiseMax(0).asDiagonal() * solver.eigenvectors().transpose();
}

std::optional<ObjectInFlight> MakeObjectInFlight(ObjectHypothesis& of_one_flight, Fits& fits) {
  const std::optional<Geolocation> absolute = AbsolutePlace(of_one_flight, fits).place;
  if (!of_one_flight.estimate.place || !absolute) return std::nullopt;
  const ObservedTracklet& tracklet = *of_one_flight.tracklets.front();
  ObjectInFlight flight{.id = ObjectId(of_one_flight),
                        .video = VideoOf(of_one_flight),
                        .model = tracklet.record.model,
                        .is_category = tracklet.is_category,
                        .relative = {},
                        .absolute = {},
                        .utc_offset_s = {},
                        .first_s = FirstTime(of_one_flight),
                        .last_s = LastTime(of_one_flight),
                        .tracklets = of_one_flight.tracklets};
  flight.SetPlaces(of_one_flight.estimate, *absolute);
  if (tracklet.start_utc_us && !tracklet.is_of_photos) {
    flight.utc_offset_s = 1e-6 * static_cast<double>(*tracklet.start_utc_us);
    flight.first_s += *flight.utc_offset_s;
    flight.last_s += *flight.utc_offset_s;
  }
  for (const ObservedTracklet* one : of_one_flight.tracklets)
    flight.observations += static_cast<double>(one->summary.observations);
  return flight;
}

bool IsAnyMoving(std::span<const ObjectInFlight* const> flights) {
  return std::ranges::any_of(flights, &ObjectInFlight::IsMoving);
}

Geolocation FuseStatic(std::span<const ObjectInFlight* const> flights) {
  Geolocation place = LastOf(flights).absolute;
  if (flights.size() == 1) return place;
  const TangentPlane plane(place.point);
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d weighted = Eigen::Vector3d::Zero();
  for (const ObjectInFlight* flight : flights) {
    const Eigen::Matrix3d of_flight = flight->absolute.covariance_enu_m2.inverse();
    information += of_flight;
    weighted += of_flight * plane.EnuFromGeodetic(flight->absolute.point);
  }
  place.covariance_enu_m2 = information.inverse();
  place.point = plane.GeodeticFromEnu(place.covariance_enu_m2 * weighted);
  place.covariance_enu_m2 = (place.covariance_enu_m2 + place.covariance_enu_m2.transpose().eval()) / 2;
  return place;
}

std::optional<PlaceDifference> CompareFlights(const ObjectInFlight& a, const ObjectInFlight& b, bool moves) {
  std::optional<PlaceDifference> difference = moves ? CompareMoving(a, b) : CompareStatic(a, b);
  if (difference) difference->flights_m2 = a.common_m2 + b.common_m2;
  return difference;
}

ObjectPlace FuseFlights(std::span<const ObjectInFlight* const> flights) {
  const bool moves = IsAnyMoving(flights);
  ObjectPlace fused{.place = moves ? FuseMoving(flights) : FuseStatic(flights),
                    .path = {},
                    .heading_rad = (moves ? LastOf(flights) : BestHeadingOf(flights)).relative.heading_rad};
  if (!moves) FuseSizeRatios(flights, fused);
  double observations = 0;
  for (const ObjectInFlight* flight : flights) {
    observations += flight->observations;
    fused.inlier_fraction += flight->observations * flight->relative.inlier_fraction;
    fused.consistent_fraction += flight->observations * flight->relative.consistent_fraction;
    fused.headings += flight->relative.headings;
    fused.contradicting_headings += flight->relative.contradicting_headings;
  }
  if (observations > 0) {
    fused.inlier_fraction /= observations;
    fused.consistent_fraction /= observations;
  }
  SetErrorRadii(*fused.place);
  return fused;
}

}  // namespace victorious

#include "victorious/place/associate/fits.h"

#include <memory>

#include <Eigen/Cholesky>

namespace victorious {
namespace {

// The absolute place: the relative one of the flight with its full common errors, which are those of `absolute` beyond
// those of `relative`.
Geolocation WithCommonErrors(Geolocation place, const Geolocation& relative, const Geolocation& absolute) {
  place.covariance_enu_m2 += absolute.covariance_enu_m2 - relative.covariance_enu_m2;
  if (Eigen::LLT<Eigen::Matrix3d>(place.covariance_enu_m2).info() != Eigen::Success)
    place.covariance_enu_m2 = absolute.covariance_enu_m2;
  return PropagatePlace(place, place.time_s);
}

}  // namespace

ObjectPlace Fits::Relative(const ObjectHypothesis& hypothesis) {
  return EstimatePlace(hypothesis, options_, kFlightErrorFraction);
}

ObjectPlace Fits::Absolute(const ObjectHypothesis& hypothesis) { return EstimatePlace(hypothesis, options_, 1); }

LevelPlace Fits::OnLevel(const ObjectHypothesis& hypothesis, const Level& level) {
  ObjectOptions on_ground = options_;
  on_ground.ground = std::make_shared<const FlatGround>(level.altitude_m - options_.centre_height_m);
  on_ground.locate.ground_sigma_m = level.sigma_m;
  LevelPlace placed{.relative = EstimatePlace(hypothesis, on_ground, kFlightErrorFraction), .absolute = {}};
  const ObjectPlace& absolute = *hypothesis.absolute;
  if (placed.relative.path_size == absolute.path_size)
    placed.absolute = WithCommonErrors(*placed.relative.place, *hypothesis.estimate.place, *absolute.place);
  return placed;
}

std::vector<Geolocation> Fits::Path(const ObjectHypothesis& hypothesis) {
  return hypothesis.estimate.path.empty() ? Relative(hypothesis).path : hypothesis.estimate.path;
}

const std::vector<std::int64_t>& Fits::Frames(const ObservedTracklet& tracklet) { return tracklet.frames; }

}  // namespace victorious

#include "victorious/associate/fits.h"

#include <memory>

namespace victorious {

ObjectPlace Fits::Relative(const ObjectHypothesis& hypothesis) {
  return EstimatePlace(hypothesis, options_, kFlightErrorFraction);
}

ObjectPlace Fits::Absolute(const ObjectHypothesis& hypothesis) { return EstimatePlace(hypothesis, options_, 1); }

ObjectPlace Fits::OnLevel(const ObjectHypothesis& hypothesis, const Level& level) {
  ObjectOptions on_ground = options_;
  on_ground.ground = std::make_shared<const FlatGround>(level.altitude_m - options_.centre_height_m);
  on_ground.locate.ground_sigma_m = level.sigma_m;
  return EstimatePlace(hypothesis, on_ground, kFlightErrorFraction);
}

std::vector<Geolocation> Fits::Path(const ObjectHypothesis& hypothesis) {
  return hypothesis.estimate.path.empty() ? Relative(hypothesis).path : hypothesis.estimate.path;
}

const std::vector<std::int64_t>& Fits::Frames(const ObservedTracklet& tracklet) { return tracklet.frames; }

}  // namespace victorious

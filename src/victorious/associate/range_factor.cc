#include "victorious/associate/range_factor.h"

#include <cmath>
#include <vector>

#include "victorious/associate/agreed_error.h"
#include "victorious/associate/object_place.h"

namespace victorious {
namespace {

constexpr std::size_t kMinObservations = 10;
constexpr double kMaxSigma = 0.04;   // of a tracklet's ratio, relative
constexpr double kAgreement = 0.04;  // of two logarithms of ratios
constexpr double kMinError = 0.06;   // of a flight, logarithm: three times the usual common error of ranges
constexpr double kMaxError = 0.25;

}  // namespace

std::optional<RangeFactor> EstimateRangeFactor(std::span<const ObservedTracklet> tracklets,
                                               const ObjectOptions& options) {
  std::vector<ErrorSample> samples;
  for (const ObservedTracklet& tracklet : tracklets) {
    if (tracklet.observations.size() < kMinObservations) continue;
    const std::optional<SizeRatio> ratio = EstimateSizeRatio(tracklet.observations, options);
    if (ratio && ratio->sigma <= kMaxSigma) samples.push_back({&tracklet, std::log(ratio->ratio)});
  }
  const auto agreed =
      FindAgreedError(samples, {.tolerance = kAgreement, .min_error = kMinError, .max_error = kMaxError});
  if (!agreed) return std::nullopt;
  return RangeFactor{.factor = std::exp(agreed->error), .objects = agreed->objects};
}

void ScaleRanges(const RangeFactor& factor, std::span<ObservedTracklet> tracklets) {
  for (ObservedTracklet& tracklet : tracklets) {
    for (BearingObservation& observation : tracklet.observations) {
      if (observation.line.range_m) *observation.line.range_m *= factor.factor;
      if (observation.line.sigma_range_m) *observation.line.sigma_range_m *= factor.factor;
    }
  }
}

}  // namespace victorious

#include "victorious/associate/range_factor.h"

#include <cmath>
#include <optional>
#include <utility>
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

std::map<std::int64_t, RangeFactor> EstimateRangeFactors(std::span<const ObservedTracklet> tracklets,
                                                         const ObjectOptions& options) {
  std::map<std::int64_t, std::vector<ErrorSample>> of_video;
  for (const ObservedTracklet& tracklet : tracklets) {
    if (tracklet.observations.size() < kMinObservations) continue;
    const std::optional<SizeRatio> ratio = EstimateSizeRatio(tracklet.observations, options);
    if (ratio && ratio->sigma <= kMaxSigma)
      of_video[tracklet.record.video].push_back({&tracklet, std::log(ratio->ratio)});
  }
  std::map<std::int64_t, RangeFactor> factors;
  for (const auto& [video, samples] : of_video) {
    const auto agreed =
        FindAgreedError(samples, {.tolerance = kAgreement, .min_error = kMinError, .max_error = kMaxError});
    if (agreed) factors[video] = {.factor = std::exp(agreed->error), .objects = agreed->objects};
  }
  return factors;
}

void ScaleRanges(const std::map<std::int64_t, RangeFactor>& factors, std::span<ObservedTracklet> tracklets) {
  for (ObservedTracklet& tracklet : tracklets) {
    const auto found = factors.find(tracklet.record.video);
    if (found == factors.end()) continue;
    for (BearingObservation& observation : tracklet.observations) {
      if (observation.line.range_m) *observation.line.range_m *= found->second.factor;
      if (observation.line.sigma_range_m) *observation.line.sigma_range_m *= found->second.factor;
    }
  }
}

}  // namespace victorious

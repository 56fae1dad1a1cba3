#include "victorious/place/associate/range_factor.h"

#include <cmath>
#include <cstddef>

#include <oneapi/tbb/parallel_for.h>

#include "victorious/place/associate/agreed_error.h"

namespace victorious {
namespace {

constexpr std::size_t kMinComparedObservations = 10;
constexpr double kMaxSigma = 0.04;   // of a tracklet's ratio, relative
constexpr double kAgreement = 0.04;  // of two logarithms of ratios
constexpr double kMinError = 0.06;   // of a flight, logarithm: three times the usual common error of ranges
constexpr double kMaxError = 0.25;

}  // namespace

std::vector<RangeComparison> CompareRanges(std::span<const ObservedTracklet> tracklets, const ObjectOptions& options) {
  std::vector<RangeComparison> comparisons(tracklets.size());
  oneapi::tbb::parallel_for(std::size_t{0}, tracklets.size(), [&](std::size_t i) {
    const std::vector<BearingObservation>& observations = tracklets[i].observations;
    if (observations.size() >= kMinComparedObservations) comparisons[i] = EstimateSizeRatio(observations, options);
  });
  return comparisons;
}

std::optional<RangeFactor> EstimateRangeFactor(std::span<const ObservedTracklet> tracklets,
                                               std::span<const RangeComparison> comparisons) {
  std::vector<ErrorSample> samples;
  for (std::size_t i = 0; i < tracklets.size(); ++i) {
    if (!comparisons[i] || !*comparisons[i]) continue;
    const SizeRatio& ratio = **comparisons[i];
    if (ratio.sigma <= kMaxSigma) samples.push_back({&tracklets[i], std::log(ratio.ratio)});
  }
  const auto agreed =
      FindAgreedError(samples, {.tolerance = kAgreement, .min_error = kMinError, .max_error = kMaxError});
  if (!agreed) return std::nullopt;
  return RangeFactor{.factor = std::exp(agreed->error), .objects = agreed->objects};
}

void ScaleRanges(double factor, ObservedTracklet& tracklet) {
  for (BearingObservation& observation : tracklet.observations) {
    if (observation.line.range_m) *observation.line.range_m *= factor;
    if (observation.line.sigma_range_m) *observation.line.sigma_range_m *= factor;
  }
}

}  // namespace victorious

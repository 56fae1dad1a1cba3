#include "victorious/associate/range_factor.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>
#include <vector>

#include "victorious/associate/object_place.h"
#include "victorious/base/median.h"

namespace victorious {
namespace {

constexpr std::size_t kMinObservations = 10;
constexpr double kMaxSigma = 0.04;   // of a tracklet's ratio, relative
constexpr double kAgreement = 0.04;  // of two logarithms of ratios
constexpr double kMinError = 0.06;   // of a flight, logarithm: three times the usual common error of ranges
constexpr double kMaxError = 0.25;

struct Sample {
  const ObservedTracklet* tracklet = nullptr;
  double log_ratio = 0;
};

bool AreDifferentObjects(const ObservedTracklet& a, const ObservedTracklet& b) {
  if (a.record.model != b.record.model) return true;
  return std::ranges::any_of(a.frames, [&](std::int64_t frame) { return std::ranges::binary_search(b.frames, frame); });
}

std::vector<Sample> Around(std::span<const Sample> samples, double log_ratio, double tolerance) {
  std::vector<Sample> near;
  std::ranges::copy_if(samples, std::back_inserter(near),
                       [&](const Sample& sample) { return std::abs(sample.log_ratio - log_ratio) <= tolerance; });
  return near;
}

RangeFactor FactorOf(std::span<const Sample> samples) {
  std::vector<Sample> largest;
  for (const Sample& sample : samples) {
    std::vector<Sample> near = Around(samples, sample.log_ratio, kAgreement);
    if (near.size() > largest.size()) largest = std::move(near);
  }
  const bool several = std::ranges::any_of(largest, [&](const Sample& sample) {
    return &sample != &largest.front() && AreDifferentObjects(*sample.tracklet, *largest.front().tracklet);
  });
  if (!several) return {};
  std::vector<double> logs;
  for (const Sample& sample : largest) logs.push_back(sample.log_ratio);
  const double error = Median(std::move(logs));
  if (std::abs(error) < kMinError || std::abs(error) > kMaxError) return {};
  if (Around(samples, 0, kMinError).size() >= largest.size()) return {};
  return {.factor = std::exp(error), .objects = static_cast<int>(largest.size())};
}

}  // namespace

std::map<std::int64_t, RangeFactor> EstimateRangeFactors(std::span<const ObservedTracklet> tracklets,
                                                         const ObjectOptions& options) {
  std::map<std::int64_t, std::vector<Sample>> of_video;
  for (const ObservedTracklet& tracklet : tracklets) {
    if (tracklet.observations.size() < kMinObservations) continue;
    const std::optional<SizeRatio> ratio = EstimateSizeRatio(tracklet.observations, options);
    if (ratio && ratio->sigma <= kMaxSigma)
      of_video[tracklet.record.video].push_back({&tracklet, std::log(ratio->ratio)});
  }
  std::map<std::int64_t, RangeFactor> factors;
  for (const auto& [video, samples] : of_video) {
    const RangeFactor factor = FactorOf(samples);
    if (factor.objects > 0) factors[video] = factor;
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

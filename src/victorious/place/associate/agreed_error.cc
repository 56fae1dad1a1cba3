#include "victorious/place/associate/agreed_error.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>
#include <vector>

#include "victorious/base/median.h"

namespace victorious {
namespace {

bool AreDifferentObjects(const ObservedTracklet& a, const ObservedTracklet& b) {
  if (a.record.model != b.record.model) return true;
  return std::ranges::any_of(a.frames, [&](std::int64_t frame) { return std::ranges::binary_search(b.frames, frame); });
}

std::vector<ErrorSample> Around(std::span<const ErrorSample> samples, double error, double tolerance) {
  std::vector<ErrorSample> near;
  std::ranges::copy_if(samples, std::back_inserter(near),
                       [&](const ErrorSample& sample) { return std::abs(sample.error - error) <= tolerance; });
  return near;
}

}  // namespace

std::optional<AgreedError> FindAgreedError(std::span<const ErrorSample> samples, const AgreementOptions& options) {
  std::vector<ErrorSample> largest;
  for (const ErrorSample& sample : samples) {
    std::vector<ErrorSample> near = Around(samples, sample.error, options.tolerance);
    if (near.size() > largest.size()) largest = std::move(near);
  }
  const bool several = std::ranges::any_of(largest, [&](const ErrorSample& sample) {
    return &sample != &largest.front() && AreDifferentObjects(*sample.tracklet, *largest.front().tracklet);
  });
  if (!several) return std::nullopt;
  std::vector<double> errors;
  for (const ErrorSample& sample : largest) errors.push_back(sample.error);
  const double error = Median(std::move(errors));
  if (std::abs(error) < options.min_error || std::abs(error) > options.max_error) return std::nullopt;
  if (Around(samples, 0, options.min_error).size() >= largest.size()) return std::nullopt;
  return AgreedError{.error = error, .objects = static_cast<int>(largest.size())};
}

}  // namespace victorious

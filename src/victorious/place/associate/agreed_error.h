// Private to associate/: an error of a flight on which several different objects agree. One object whose observations
// contradict the telemetry may move, or be of another size; if several agree on the contradiction, and more than see
// none, the telemetry is wrong.
#pragma once

#include <optional>
#include <span>

#include "victorious/place/associate/observed_tracklet.h"

namespace victorious {

/// The error that one tracklet shows.
struct ErrorSample {
  const ObservedTracklet* tracklet = nullptr;
  double error = 0;
};

struct AgreementOptions {
  double tolerance = 0;  ///< within which two samples agree
  double min_error = 0;  ///< a smaller one is usual, and none
  double max_error = 0;  ///< a larger one has another cause
};

struct AgreedError {
  double error = 0;
  int objects = 0;  ///< tracklets that agree on it
};

/// The median of the largest set of agreeing samples; std::nullopt if they are of one object, if at least as many show
/// no error, or if the median is out of range.
[[nodiscard]] std::optional<AgreedError> FindAgreedError(std::span<const ErrorSample> samples,
                                                         const AgreementOptions& options);

}  // namespace victorious

#include "victorious/place/calibrate/clock_prior.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "victorious/base/median.h"

namespace victorious {
namespace {

// Recorders begin and end within some frames of each other. Telemetry of few rows begins within a row of the video.
constexpr double kSameEnd_s = 0.5;
constexpr double kSameEndRows = 1.5;

// The longest that encoders use, with few exceptions.
constexpr double kKeyFrameInterval_s = 10;

double MedianInterval(std::span<const CameraState> states) {
  std::vector<double> intervals_s;
  for (std::size_t i = 1; i < states.size(); ++i) intervals_s.push_back(states[i].time_s - states[i - 1].time_s);
  return MedianOr(std::move(intervals_s), 0);
}

}  // namespace

ClockPrior MakeClockPrior(std::span<const CameraState> states, std::optional<double> duration_s,
                          const TelemetryOptions& options) {
  if (states.empty() || options.clock_sigma_s == 0) return {};
  const double same_s = std::max(kSameEnd_s, kSameEndRows * MedianInterval(states));
  const double begin_s = states.front().time_s;
  const double end_s = duration_s ? states.back().time_s - *duration_s : begin_s;
  ClockPrior prior{.sigma_s = options.clock_sigma_s};
  // A stream that begins between two key frames has telemetry before the first frame that can be decoded.
  const bool begins_between_keys = begin_s < 0 && begin_s >= -kKeyFrameInterval_s && duration_s.has_value();
  if ((std::abs(begin_s) <= same_s || begins_between_keys) && std::abs(end_s) <= same_s) return prior;
  // By chance, another recording is hardly as long as the video to within this.
  const bool is_as_long = duration_s && std::abs(end_s - begin_s) <= same_s / 2;
  if (is_as_long && std::abs(begin_s) < *duration_s) {
    prior.extent = TelemetryExtent::kDisplaced;
    prior.offset_s = -begin_s;
    return prior;
  }
  prior.extent = TelemetryExtent::kOther;
  prior.sigma_s = std::max(options.clock_sigma_s, options.clock_sigma_apart_s);
  return prior;
}

}  // namespace victorious

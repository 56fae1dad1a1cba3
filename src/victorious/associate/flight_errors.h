// The errors of flights that their own lines of sight contradict: yaw (heading_error.h), then ranges (range_factor.h).
// They are properties of a video's tracklets alone, and are estimated anew only for videos whose tracklets changed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "victorious/associate/associate_objects.h"
#include "victorious/associate/heading_error.h"
#include "victorious/associate/object_options.h"
#include "victorious/associate/range_factor.h"

namespace victorious {

struct FlightErrors {
  std::optional<HeadingError> heading;
  std::optional<RangeFactor> range;
};

/// The errors of the videos of one index, remembered between data associations with the same options. Thread-safe.
class FlightErrorCache {
 public:
  /// Corrects all tracklets, and returns the errors by video. Estimates only those of videos whose tracklets differ
  /// from the ones given last.
  std::map<std::int64_t, FlightErrors> Correct(std::span<ObservedTracklet> tracklets, const ObjectOptions& options);

  /// Number of videos estimated so far, repetitions included.
  [[nodiscard]] std::int64_t estimates() const;

 private:
  using Contents = std::vector<std::pair<std::int64_t, std::size_t>>;  // ids of tracklets, and their observations
  struct Entry {
    Contents contents;
    FlightErrors errors;
  };

  mutable std::mutex mutex_;
  std::map<std::int64_t, Entry> of_video_;
  std::int64_t estimates_ = 0;
};

/// What the errors of one video mean, one line each.
[[nodiscard]] std::vector<std::string> Describe(const FlightErrors& errors);

}  // namespace victorious

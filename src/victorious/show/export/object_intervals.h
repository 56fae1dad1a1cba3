// The sightings of one object in one video, in a row, cut where it was out of view.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/show/export/export_format.h"

namespace victorious {

/// Sightings of an object with less than this between them are one interval, s: searches are some tenths of a second
/// apart, and `--every N` may leave gaps.
inline constexpr double kMaxGap_s = 1;

/// Visits the sightings of an object that match the filter, in the order of time.
/// @param visit  with `begins`: the first one of an interval
[[nodiscard]] Status VisitIntervals(const ExportRequest& request, std::int64_t object,
                                    const std::function<void(const SightingRecord& sighting, bool begins)>& visit);

}  // namespace victorious

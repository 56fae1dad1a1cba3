// What formats of one video share.
#pragma once

#include <string_view>

#include "victorious/base/error.h"
#include "victorious/show/export/export_format.h"

namespace victorious {

/// Sightings of an object that are further apart than this are of two intervals, s. Searches are some tenths of a
/// second apart, and `--every N` leaves gaps.
inline constexpr double kMaxIntervalGap_s = 1;

/// The video that matches the filter; nullptr: none does. Error: kInvalidArgument, with their names, if there are more.
/// @param format  its name, for the message
[[nodiscard]] Expected<const VideoRecord*> FindSingleVideo(const ExportRequest& request, std::string_view format);

}  // namespace victorious

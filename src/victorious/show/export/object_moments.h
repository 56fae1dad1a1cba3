// When the videos show each object. Times belong to a video: those of different videos have only UTC in common.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/store/catalogue.h"
#include "victorious/store/index_store.h"
#include "victorious/types/json_values.h"

namespace victorious {

/// An object in one video, from its first to its last sighting there.
struct ObjectMoment {
  std::int64_t video = 0;
  std::string video_name;                    ///< ShownName
  double first_time_s = 0;                   ///< presentation times in this video
  double last_time_s = 0;                    ///< likewise
  std::int64_t frames = 0;                   ///< with a sighting
  std::optional<std::int64_t> start_utc_us;  ///< of the video (VideoRecord)

  /// UTC of a time in this video, microseconds since 1970; std::nullopt: the video does not tell it.
  [[nodiscard]] std::optional<std::int64_t> UtcOf(double time_s) const;
};

/// Of seconds in a UTC text.
inline constexpr int kUtcDecimals = 3;

using MomentsByObject = std::map<std::int64_t, std::vector<ObjectMoment>>;

/// Returns the moments of all objects, by object id and then by video id.
/// @param videos  all of the index
[[nodiscard]] Expected<MomentsByObject> ReadMoments(IndexStore& store, const Catalogue& videos);

/// UTC from the first to the last sighting; std::nullopt unless all videos that show the object tell it.
struct UtcSpan {
  std::int64_t begin_us = 0;
  std::int64_t end_us = 0;
};
[[nodiscard]] std::optional<UtcSpan> SpanOf(const std::vector<ObjectMoment>& moments);

/// The key `moments` of the format `objects` (docs/formats/export.md).
[[nodiscard]] Json MomentsJson(const std::vector<ObjectMoment>& moments);

}  // namespace victorious

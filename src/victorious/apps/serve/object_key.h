// A name of an object that outlives its id, which changes when a video is searched again: what a link to the object
// needs. Input: the object's first sighting. Output: a text of the video's content, the time, the box and the model, as
// reviews are bound to these (docs/formats/index.md); and back to the sighting of the present object.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "victorious/geometry/box.h"
#include "victorious/types/index_records.h"

namespace victorious {

/// The first sighting of an object, as its key gives it.
struct KeyedSighting {
  std::uint64_t content = 0;  ///< checksum of the content id, which may have the password of a live source
  std::int64_t time_us = 0;   ///< of the sighting
  Box box;                    ///< whole pixels
  std::string model;          ///< name

  /// Whether a sighting of this video and model shows the object: at this time, in a box that overlaps this one by half
  /// or more (intersection over union).
  [[nodiscard]] bool IsAt(const SightingRecord& sighting) const;
  /// Whether it is of this video.
  [[nodiscard]] bool IsIn(const VideoRecord& video) const;

  bool operator==(const KeyedSighting&) const = default;
};

/// "0123456789abcdef.1500000.40.30.100.60.jeep"
[[nodiscard]] std::string FormatObjectKey(const VideoRecord& video, const SightingRecord& first,
                                          std::string_view model);

/// std::nullopt for a text that FormatObjectKey does not write.
[[nodiscard]] std::optional<KeyedSighting> ParseObjectKey(std::string_view key);

}  // namespace victorious

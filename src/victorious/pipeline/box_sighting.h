// A box that a person drew, and where its object was seen: what user-specified tracking (track_run.h) is given and
// tells.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "victorious/geometry/box.h"
#include "victorious/types/place.h"
#include "victorious/types/sight.h"

namespace victorious {

/// A box around an object, in the first frame at this time or later.
struct DrawnBox {
  Box box;                ///< px
  double at_s = 0;        ///< since the video's first frame
  std::string type = {};  ///< what it is (object_type.h), or empty
};

/// One object in one frame.
struct BoxSighting {
  std::size_t drawn = 0;  ///< which of the boxes
  std::size_t video = 0;  ///< 0: the one drawn in; from 1: the others
  std::int64_t frame = 0;
  double time_s = 0;
  Box box;                             ///< px, clipped to the frame
  Box extent;                          ///< the same where it goes on beyond the frame, px
  double score = 0;                    ///< 0 to 1: the tracker's trust, or the recogniser's score
  std::optional<std::size_t> matches;  ///< where the recogniser found it
  std::optional<Sight> sight;          ///< where there is telemetry
  std::optional<Place> place;          ///< of the object at that time, where the lines of sight tell it
};

/// What a drawn box's object is called, by its number from 0: "box-1", "box-2", …
[[nodiscard]] std::string BoxName(std::size_t drawn);

/// JSON Lines as of docs/formats/export.md, with BoxName as `model`.
std::string ToJsonLines(std::span<const BoxSighting> sightings, std::span<const std::string> videos,
                        std::span<const DrawnBox> boxes);

}  // namespace victorious

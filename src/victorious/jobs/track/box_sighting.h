// User boxes and sightings of their objects: input and output of user-specified tracking (track_job.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "victorious/geometry/box.h"
#include "victorious/types/bearing_observation.h"
#include "victorious/types/geolocation.h"

namespace victorious {

/// A box that a user drew around an object, in the first frame at or after a time.
struct UserBox {
  Box box;                ///< px
  double at_s = 0;        ///< s since the video's first frame
  std::string type = {};  ///< object type (object_type.h), or empty
};

/// One object in one frame.
struct BoxSighting {
  std::size_t box_index = 0;  ///< index into the user boxes
  std::size_t video = 0;      ///< index of the video: 0 holds the user boxes; from 1: the other videos
  std::int64_t frame = 0;
  double time_s = 0;
  Box box;                                        ///< px, clipped to the frame
  Box extent;                                     ///< px, not clipped
  double score = 0;                               ///< 0 to 1: the tracker's confidence, or the recogniser's score
  std::optional<std::size_t> matches;             ///< number of inliers, if the recogniser found it
  std::optional<BearingObservation> observation;  ///< bearing observation, if there is telemetry
  std::optional<Geolocation> place;               ///< of the object at `time_s`, if the lines of sight determine it
};

/// Name of a user box's object: "box-1" for index 0, "box-2" for index 1, …
[[nodiscard]] std::string BoxName(std::size_t box_index);

/// JSON Lines (docs/formats/export.md), with BoxName as `model`.
std::string ToJsonLines(std::span<const BoxSighting> sightings, std::span<const std::string> videos,
                        std::span<const UserBox> boxes);

}  // namespace victorious

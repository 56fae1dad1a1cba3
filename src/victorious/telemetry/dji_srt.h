// The subtitles that DJI aircraft write beside their videos (.SRT) or into them: a text a moment, in one of many
// dialects. Known: "[latitude: 1] [longitude: 2] [rel_alt: 3 abs_alt: 4]" with or without the gimbal's angles, also
// with "longtitude"; "GPS(longitude, latitude, satellites) BAROMETER:m"; "GPS(latitude, longitude, heightM)" of the
// Matrice 300; "GPS (…), HOME (longitude, latitude, heightm), H m, G.PRY (pitch, roll, yaw)" of the Phantom 4 RTK.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "victorious/types/camera_state.h"

namespace victorious {

/// What one text says; the state's time is 0. Nothing for a text without a place, and for the place 0, 0 that stands
/// for none; of unknown datum where no height is told.
[[nodiscard]] std::optional<CameraState> CameraFromDjiText(std::string_view text);

struct DjiSubtitles {
  std::vector<CameraState> states;    ///< by the cues' own times
  std::vector<std::string> warnings;  ///< cut off, without times, …
  int cues = 0;                       ///< texts, with a place or without
};

/// Whether the text is subtitles with anything that DJI writes.
[[nodiscard]] bool LooksLikeDjiSrt(std::string_view text);

/// A whole .SRT file. Files without cue times are timed by the moments that stand in their texts, from the first.
[[nodiscard]] DjiSubtitles ParseDjiSrt(std::string_view text);

}  // namespace victorious

// telemetry/: the subtitles that aircraft write beside their videos (.SRT) or into them: one text per time, in one of
// many dialects. Of DJI: "[latitude: 1] [longitude: 2] [rel_alt: 3 abs_alt: 4]" with or without the gimbal's angles,
// also with "longtitude"; "GPS(longitude, latitude, satellites) BAROMETER:m"; "GPS(latitude, longitude, heightM)" of
// the Matrice 300; "GPS (…), HOME (longitude, latitude, heightm), H m, G.PRY (pitch, roll, yaw)" of the Phantom 4 RTK.
// Of Autel: "GPS(W: longitude, N: latitude, heightm)", letters first, with G.PRY.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "victorious/input/telemetry/gps_order.h"
#include "victorious/types/camera_state.h"

namespace victorious {

/// The attitude of a camera with these gimbal angles, degrees: the yaw clockwise from north, the pitch above the
/// horizon.
/// @return std::nullopt if one of them is missing, or the pitch beyond 180
[[nodiscard]] std::optional<Attitude> AttitudeFromGimbal(std::optional<double> yaw_deg, std::optional<double> pitch_deg,
                                                         std::optional<double> roll_deg);

/// Which height of a text is taken that has both: the take-off's own height may be known better than the sea's.
enum class DjiHeight { kAboveSea, kAboveTakeoff };

/// How "GPS(a, b, c)" is read. Letters (N, E, S, W) and angles beyond 90 degrees decide before it.
struct DjiReading {
  DjiHeight height = DjiHeight::kAboveSea;
  GpsOrder order = GpsOrder::kByText;
};

/// Parses one text. The state's time is 0; its datum is kUnknown if the text has no height.
/// @return std::nullopt for a text without a position, or with the position 0, 0, which means "no fix"
[[nodiscard]] std::optional<CameraState> CameraFromDjiText(std::string_view text, const DjiReading& reading = {});

/// Whether "GPS(a, b, c)" of a text may be in either order: c is a height, and no letter and no angle beyond 90 degrees
/// says which is the longitude. Aircraft write both.
[[nodiscard]] bool HasAmbiguousGpsOrder(std::string_view text);

/// Whether a text is of an Autel aircraft: letters before the numbers of its position.
[[nodiscard]] bool IsAutelText(std::string_view text);

/// The height of the take-off above the sea that a text implies, metres: its height above the sea less that above the
/// take-off; std::nullopt if it lacks one of them.
[[nodiscard]] std::optional<double> TakeoffAltitudeFromDjiText(std::string_view text);

/// The height of a text that names only "altitude", metres: above the sea for some aircraft, above the take-off for
/// others. std::nullopt for texts that say which.
[[nodiscard]] std::optional<double> AmbiguousAltitudeFromDjiText(std::string_view text);

struct DjiSubtitles {
  std::vector<CameraState> states;    ///< with the times of their cues
  std::vector<std::string> warnings;  ///< truncated cues, cues without a time, …
  int cues = 0;                       ///< number of texts, with or without a position
  std::vector<double> takeoff_m;      ///< the heights of the take-off that texts imply
  std::vector<double> ambiguous_m;    ///< the heights of texts that name only "altitude"
  int ambiguous_orders = 0;           ///< texts whose order of latitude and longitude is a guess
  bool is_autel = false;              ///< of an Autel aircraft
};

/// Adds what a text says besides its state, for the warnings about it.
void AddDjiRemarks(std::string_view text, DjiSubtitles& subtitles);

/// Adds a warning for the cues without a position, and one for those without a time.
void WarnOfSkippedCues(int without_place, int without_time, DjiSubtitles& subtitles);

/// Whether one text has a keyword that DJI aircraft write.
[[nodiscard]] bool HasDjiKeyword(std::string_view text);

/// Whether the text is subtitles with such a keyword.
[[nodiscard]] bool LooksLikeDjiSrt(std::string_view bytes);

/// Parses a whole .SRT file, or .ass. A last text that ends before those before it is cut off, and gives no state. If
/// the cues have no times, the UTC times in their texts are used, relative to the first.
[[nodiscard]] DjiSubtitles ParseDjiSrt(std::string_view bytes, const DjiReading& reading = {});

}  // namespace victorious

// telemetry/: entry point. In: KLV (MISB ST 0601, EG 0104), DJI subtitles, a table, as bytes or as a video's data
// packets, or photos with EXIF and XMP. Out: camera states on the video's clock, with heights above the ellipsoid if
// the datum can be converted.
//
//   bytes -> packets, cues or rows -> CameraState, each with its own datum -> order, clock, datum -> Telemetry
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/base/options.h"
#include "victorious/input/telemetry/gps_order.h"
#include "victorious/input/telemetry/klv_packet.h"
#include "victorious/types/camera_state.h"
#include "victorious/types/data_packet.h"

namespace victorious {

struct PhotoMetadata;

/// telemetry.cc gives ranges, units and reasons.
struct TelemetryOptions {
  double time_offset_s = 0;
  double clock_sigma_s = 0.3;
  double clock_sigma_apart_s = 2;
  double max_gap_s = 2;
  std::optional<VerticalDatum> vertical_datum;  ///< of the heights; std::nullopt: as the format or the table gives it
  GpsOrder gps_order = GpsOrder::kByText;
  std::string geoid_grid;
  std::optional<double> takeoff_altitude_m;  ///< std::nullopt: unknown
  std::optional<double> hfov_deg;            ///< std::nullopt: from the telemetry
  /// The attitude of states that have none (given_attitude.h), of footage without gimbal angles: elevation of the
  /// optical axis, -90 straight down, and yaw clockwise from north; without a yaw, the course over ground. Not user
  /// parameters: they describe one video, as its telemetry file does.
  std::optional<double> camera_pitch_deg;
  std::optional<double> camera_yaw_deg;
  /// The camera (camera_models.h), which gives the field of view; empty: that of the telemetry, if it names one. Not a
  /// user parameter, for the same reason.
  std::string camera_model;

  void ListFields(FieldList& fields);
};

/// The format of a source; `kNone` for a video without telemetry.
enum class TelemetryFormat { kNone, kSt0601, kEg0104, kOtherKlv, kDjiSubtitles, kAutelSubtitles, kTable, kPhotos };

inline constexpr auto kTelemetryFormatTexts = std::to_array<EnumText<TelemetryFormat>>(
    {{TelemetryFormat::kNone, "none"},
     {TelemetryFormat::kSt0601, ToText(kKlvStandardTexts, KlvStandard::kSt0601)},
     {TelemetryFormat::kEg0104, ToText(kKlvStandardTexts, KlvStandard::kEg0104)},
     {TelemetryFormat::kOtherKlv, "KLV of another standard"},
     {TelemetryFormat::kDjiSubtitles, "DJI subtitles"},
     {TelemetryFormat::kAutelSubtitles, "Autel subtitles"},
     {TelemetryFormat::kTable, "table"},
     {TelemetryFormat::kPhotos, "photos"}});

struct Telemetry {
  TelemetryFormat format = TelemetryFormat::kNone;
  std::vector<CameraState> states;    ///< by strictly increasing time
  std::vector<KlvPacket> packets;     ///< of KLV: all, as decoded
  int records = 0;                    ///< number of packets, subtitles or rows
  std::vector<std::string> warnings;  ///< one line per defect of the data
  /// The fields of view follow from focal lengths or camera models, which mean the long side of the picture.
  bool hfov_is_of_long_side = false;
};

/// What a telemetry file may be, for messages.
inline constexpr std::string_view kTelemetryFiles =
    "KLV, subtitles of DJI or Autel aircraft, or a table with time_s and latitude_deg";

/// Whether the bytes are those of a telemetry file rather than of a video.
[[nodiscard]] bool LooksLikeTelemetry(std::string_view bytes);

/// Parses a telemetry file; the content determines the format. The first valid packet of bare KLV defines time 0.
/// Errors: kInvalidArgument for bytes without readable telemetry and for invalid options; kDataLoss for KLV that is
/// only truncated units.
[[nodiscard]] Expected<Telemetry> ParseTelemetry(std::string_view bytes, const TelemetryOptions& options);

/// Parses the telemetry of a video: its KLV or, if it has none, its subtitles. `records` is 0 if it has neither.
/// Errors: kInvalidArgument for invalid options.
[[nodiscard]] Expected<Telemetry> TelemetryFromPackets(std::span<const DataPacket> packets,
                                                       const TelemetryOptions& options);

/// Fits fields of view to a picture of this size, px; does so once. Of an upright picture the long side is the height.
void FitToImage(int width, int height, Telemetry& telemetry);

/// The camera states of photos (photo.h), by increasing time. They hold at their own times only: the times of photos in
/// a folder are invented, so nothing between them is known.
/// Errors: kInvalidArgument for invalid options.
[[nodiscard]] Expected<Telemetry> TelemetryFromPhotos(std::span<const PhotoMetadata> photos,
                                                      const TelemetryOptions& options);

}  // namespace victorious

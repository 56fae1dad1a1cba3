// telemetry/, in: KLV (MISB ST 0601, EG 0104), DJI subtitles or a table, as bytes or as a video's data packets. Out:
// the camera's states on the video's clock, heights above the ellipsoid where it can be told.
//
//   bytes -> packets, cues or rows -> CameraState, each with its own datum -> order, clock, datum -> Telemetry
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "victorious/base/error.h"
#include "victorious/base/options.h"
#include "victorious/telemetry/klv_packet.h"
#include "victorious/types/camera_state.h"
#include "victorious/types/data_packet.h"

namespace victorious {

struct TelemetryOptions {
  static constexpr double kUnknownHeight = -9999;  ///< m

  double time_offset_s = 0;
  double max_gap_s = 2;
  std::string vertical_datum = "told";
  std::string geoid_grid;
  double takeoff_altitude_m = kUnknownHeight;
  double hfov_deg = 0;

  void ListFields(FieldList& fields);
};

struct Telemetry {
  std::string format;                 ///< "MISB ST 0601", "MISB EG 0104", "DJI subtitles", "table"
  std::vector<CameraState> states;    ///< by strictly rising time
  std::vector<KlvPacket> packets;     ///< where it is KLV: all of them, as they stand
  int records = 0;                    ///< packets, subtitles or rows that were read
  std::vector<std::string> warnings;  ///< a line for each thing that is not as it should be
};

/// Whether bytes are of a file of telemetry, and not of a video.
[[nodiscard]] bool LooksLikeTelemetry(std::string_view bytes);

/// A file of telemetry by its content. The first packet of bare KLV is the time 0.
/// Errors: kInvalidArgument for what holds no telemetry or none that can be read, and for options that do not fit.
Expected<Telemetry> ParseTelemetry(std::string_view bytes, const TelemetryOptions& options);

/// Out of a video: its KLV or, if it has none, its subtitles. `records` is 0 where it has neither.
/// Errors: those of the options.
Expected<Telemetry> TelemetryFromPackets(std::span<const DataPacket> packets, const TelemetryOptions& options);

/// Every item of every KLV packet by its number and name, checksums, time stamps; the states; the warnings.
nlohmann::json ToJson(const Telemetry& telemetry);

/// In plain words, a line each: what it holds, and what is missing for a place on the map.
[[nodiscard]] std::vector<std::string> DescribeTelemetry(const Telemetry& telemetry);

}  // namespace victorious

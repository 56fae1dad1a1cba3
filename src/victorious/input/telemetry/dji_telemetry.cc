#include "victorious/input/telemetry/dji_telemetry.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "victorious/base/median.h"
#include "victorious/input/telemetry/camera_models.h"
#include "victorious/input/telemetry/subtitle_cues.h"

namespace victorious {
namespace {

// A take-off this far below the sea is taken for an error of the height: the dry land that people fly from is below -30
// m in a few basins only.
constexpr double kLowestTakeoff_m = -30;

// DJI's aircraft fly no higher than 500 m above their take-off: what is higher is above the sea. A clip that comes as
// low as this is of an aircraft that starts or lands, and its heights are above the take-off.
constexpr double kHighestAboveTakeoff_m = 500;
constexpr double kNearTakeoff_m = 5;

// Decides what "altitude" alone is above, where the heights tell it; else it stays the take-off, and a warning says so.
void ResolveAmbiguousHeights(const std::vector<double>& heights_m, const TelemetryOptions& options,
                             Telemetry& telemetry) {
  if (heights_m.empty() || options.vertical_datum) return;
  const auto [lowest, highest] = std::ranges::minmax_element(heights_m);
  if (*lowest < kNearTakeoff_m && *highest <= kHighestAboveTakeoff_m) return;
  constexpr std::string_view kFlag = "--vertical-datum takeoff or egm96 (the sea) says what they are above";
  if (*highest <= kHighestAboveTakeoff_m) {
    telemetry.warnings.push_back(
        fmt::format("the heights (altitude, {:.0f} to {:.0f} m) are taken for heights above the take-off, but some "
                    "aircraft write those above the sea there: {}",
                    *lowest, *highest, kFlag));
    return;
  }
  for (CameraState& state : telemetry.states) {
    if (state.datum == VerticalDatum::kTakeoff) state.datum = VerticalDatum::kEgm96;
  }
  telemetry.warnings.push_back(fmt::format(
      "the heights (altitude, up to {:.0f} m) are taken for heights above the sea: no such aircraft flies so "
      "high above its take-off; {}",
      *highest, kFlag));
}

std::string_view TextOf(const DataPacket& packet) {
  return {reinterpret_cast<const char*>(packet.bytes.data()), packet.bytes.size()};
}

}  // namespace

DjiHeight HeightOf(const TelemetryOptions& options) {
  return options.takeoff_altitude_m ? DjiHeight::kAboveTakeoff : DjiHeight::kAboveSea;
}

DjiReading ReadingOf(const TelemetryOptions& options) {
  return {.height = HeightOf(options), .order = options.gps_order};
}

void WarnOfTakeoffHeight(std::vector<double> takeoff_m, std::string_view word, const TelemetryOptions& options,
                         std::vector<std::string>& warnings) {
  if (takeoff_m.empty() || HeightOf(options) == DjiHeight::kAboveTakeoff) return;
  const double median_m = Median(std::move(takeoff_m));
  if (median_m >= kLowestTakeoff_m) return;
  warnings.push_back(
      fmt::format("the heights above the sea ({}) put the take-off {:.0f} m below it, and the camera under the ground: "
                  "give --takeoff, the height of the take-off above the ellipsoid",
                  word, -median_m));
}

Telemetry TelemetryFromDji(DjiSubtitles subtitles, const TelemetryOptions& options) {
  Telemetry telemetry;
  telemetry.format = subtitles.is_autel ? TelemetryFormat::kAutelSubtitles : TelemetryFormat::kDjiSubtitles;
  telemetry.records = subtitles.cues;
  telemetry.states = std::move(subtitles.states);
  telemetry.warnings = std::move(subtitles.warnings);
  telemetry.hfov_is_of_long_side = true;
  const CameraModel* camera = FindCameraModel(options.camera_model);
  const auto has_hfov = [](const CameraState& state) { return state.hfov_rad.has_value(); };
  if (camera != nullptr) {
    for (CameraState& state : telemetry.states) {
      if (state.hfov_rad) state.hfov_rad = FieldOfView(*camera, FocalFromFieldOfView(*state.hfov_rad));
    }
  } else if (!options.hfov_deg && std::ranges::any_of(telemetry.states, has_hfov)) {
    telemetry.warnings.emplace_back(
        "the field of view is estimated from the focal length, within 4 % for an uncropped image: --camera or --hfov "
        "gives it exactly");
  }
  if (subtitles.ambiguous_orders > 0 && options.gps_order == GpsOrder::kByText) {
    telemetry.warnings.emplace_back(
        "GPS(a, b, height) has two orders: the latitude is taken to be first; --gps-order longitude_first turns it");
  }
  WarnOfTakeoffHeight(std::move(subtitles.takeoff_m), "abs_alt", options, telemetry.warnings);
  ResolveAmbiguousHeights(subtitles.ambiguous_m, options, telemetry);
  return telemetry;
}

bool HasDjiSubtitle(std::span<const DataPacket> packets) {
  return std::ranges::any_of(packets, [](const DataPacket& packet) {
    return packet.kind == DataKind::kSubtitle && HasDjiKeyword(TextOf(packet));
  });
}

DjiSubtitles ParseSubtitlePackets(std::span<const DataPacket> packets, const DjiReading& reading) {
  DjiSubtitles subtitles;
  int without_place = 0;
  int without_time = 0;
  for (const DataPacket& packet : packets) {
    if (packet.kind != DataKind::kSubtitle) continue;
    ++subtitles.cues;
    const std::string text = WithLineBreaks(TextOf(packet));
    auto state = CameraFromDjiText(text, reading);
    AddDjiRemarks(text, subtitles);
    if (!state || !packet.time_s) {
      ++(state ? without_time : without_place);
      continue;
    }
    state->time_s = *packet.time_s;
    subtitles.states.push_back(*state);
  }
  WarnOfSkippedCues(without_place, without_time, subtitles);
  return subtitles;
}

}  // namespace victorious

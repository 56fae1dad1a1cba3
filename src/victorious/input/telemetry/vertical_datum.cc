#include "victorious/input/telemetry/vertical_datum.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "victorious/input/telemetry/geoid.h"
#include "victorious/types/vertical_datum.h"

namespace victorious {
namespace {

bool HasDatum(const std::vector<CameraState>& states, VerticalDatum datum) {
  return std::ranges::find(states, datum, &CameraState::datum) != states.end();
}

void ApplyUndulation(std::vector<CameraState>& states, VerticalDatum datum, const Geoid& geoid) {
  for (CameraState& state : states) {
    if (state.datum != datum) continue;
    if (const auto height_m = geoid.UndulationAt(state.place.latitude_rad, state.place.longitude_rad)) {
      state.place.altitude_m += *height_m;
      state.datum = VerticalDatum::kEllipsoid;
    }
  }
}

// The user's grid applies to either geoid; PROJ's own only to EGM96.
Expected<std::optional<Geoid>> LoadGeoid(VerticalDatum datum, const TelemetryOptions& options) {
  if (!options.geoid_grid.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(Geoid geoid, Geoid::Read(options.geoid_grid));
    return geoid;
  }
  const auto path = datum == VerticalDatum::kEgm96 ? FindEgm96Grid() : std::nullopt;
  if (!path) return std::nullopt;
  VICTORIOUS_ASSIGN_OR_RETURN(Geoid geoid, Geoid::Read(*path));
  return geoid;
}

Status ConvertFromGeoid(std::vector<CameraState>& states, VerticalDatum datum, const TelemetryOptions& options,
                        std::vector<std::string>& warnings) {
  if (!HasDatum(states, datum)) return {};
  VICTORIOUS_ASSIGN_OR_RETURN(const auto geoid, LoadGeoid(datum, options));
  if (geoid) ApplyUndulation(states, datum, *geoid);
  if (HasDatum(states, datum)) {
    warnings.push_back(
        fmt::format("heights are above mean sea level ({}) and are not converted: no geoid grid covers the position: "
                    "set telemetry.geoid_grid to a .gtx grid or, for a drone, give --takeoff (the height of the "
                    "take-off above the ellipsoid)",
                    ToText(kVerticalDatumTexts, datum)));
  }
  return {};
}

}  // namespace

Status ConvertToEllipsoid(std::vector<CameraState>& states, const TelemetryOptions& options,
                          std::vector<std::string>& warnings) {
  if (HasDatum(states, VerticalDatum::kUnknown)) {
    warnings.emplace_back("a camera position has no height: it cannot be used for geolocation");
  }
  if (options.vertical_datum) {
    for (CameraState& state : states) {
      if (state.datum != VerticalDatum::kUnknown) state.datum = *options.vertical_datum;
    }
  }
  VICTORIOUS_RETURN_IF_ERROR(ConvertFromGeoid(states, VerticalDatum::kEgm96, options, warnings));
  VICTORIOUS_RETURN_IF_ERROR(ConvertFromGeoid(states, VerticalDatum::kEgm2008, options, warnings));
  if (!HasDatum(states, VerticalDatum::kTakeoff)) return {};
  if (!options.takeoff_altitude_m) return {};  // telemetry.cc names the flag that is missing
  for (CameraState& state : states) {
    if (state.datum != VerticalDatum::kTakeoff) continue;
    state.place.altitude_m += *options.takeoff_altitude_m;
    state.datum = VerticalDatum::kEllipsoid;
  }
  return {};
}

}  // namespace victorious

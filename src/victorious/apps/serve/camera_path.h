// The path of the camera and its footprints on the ground, for the map. From the video's telemetry, else from the
// camera positions that its sightings store.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "victorious/base/enum_text.h"
#include "victorious/base/error.h"
#include "victorious/geometry/geodesy.h"
#include "victorious/types/camera_state.h"

namespace victorious {

/// The ground that the frame shows: its corners in the order left top, right top, right bottom, left bottom.
using Footprint = std::array<GeodeticPoint, 4>;

/// The footprint on flat ground; std::nullopt if the state is not complete, or a corner looks at or above the horizon,
/// or at ground more than 20 km away. The lens's distortion is ignored.
/// @param ground_m  height of the ground above the ellipsoid
[[nodiscard]] std::optional<Footprint> ComputeFootprint(const CameraState& camera, int width_px, int height_px,
                                                        double ground_m);

struct CameraPathPoint {
  double time_s = 0;
  GeodeticPoint place;
  std::optional<double> yaw_rad;
  std::optional<Footprint> footprint;
};

/// Where a path is from.
enum class CameraPathSource {
  kTelemetry,
  kSightings,  ///< the camera positions stored with sightings
};

inline constexpr auto kCameraPathSourceTexts = std::to_array<EnumText<CameraPathSource>>(
    {{CameraPathSource::kTelemetry, "telemetry"}, {CameraPathSource::kSightings, "sightings"}});

struct CameraPath {
  std::optional<CameraPathSource> source;  ///< std::nullopt: there is no path
  std::string reason;              ///< why there is no path, or why it has no footprints; empty: nothing is missing
  std::optional<double> ground_m;  ///< height above the ellipsoid that the footprints assume
  std::vector<CameraPathPoint> points;  ///< by time
};

/// Thins a path to at most `max_points`, evenly in time, with its ends.
[[nodiscard]] std::vector<CameraState> ThinStates(const std::vector<CameraState>& states, std::size_t max_points);

/// The path of complete or incomplete states, with footprints where these are known.
[[nodiscard]] CameraPath MakeCameraPath(const std::vector<CameraState>& states, CameraPathSource source, int width_px,
                                        int height_px, std::optional<double> ground_m);

}  // namespace victorious

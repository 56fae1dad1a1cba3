// Where a camera was, how it was held and how wide it saw, at one moment of a video.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "victorious/geometry/attitude.h"
#include "victorious/geometry/geodesy.h"

namespace victorious {

/// What heights are counted from.
enum class VerticalDatum {
  kEllipsoid,  ///< WGS 84's
  kEgm96,      ///< mean sea level, as the geoid EGM96 has it
  kEgm2008,    ///< mean sea level, as the geoid EGM2008 has it
  kTakeoff,    ///< the place where the aircraft took off
  kUnknown,    ///< nothing: no height is told, and the altitude means nothing
};

struct CameraState {
  double time_s = 0;    ///< on the video's clock: since its first frame
  GeodeticPoint place;  ///< of the centre of projection, WGS 84; its altitude counts from `datum`
  VerticalDatum datum = VerticalDatum::kEllipsoid;  ///< another only where nothing tells how to get to the ellipsoid
  std::optional<Attitude> attitude;                 ///< of the camera, against north and the vertical at `place`
  std::optional<double> hfov_rad;                   ///< full horizontal field of view, (0, pi)
  std::optional<double> sigma_position_m;           ///< standard deviation along each axis
  std::optional<double> sigma_attitude_rad;         ///< standard deviation about each axis
  std::optional<std::int64_t> utc_us;               ///< microseconds since 1970-01-01 UTC
  std::optional<std::array<double, 5>> distortion;  ///< k1, k2, p1, p2, k3 in OpenCV's model and order

  /// A line of sight can be placed on the Earth.
  [[nodiscard]] bool IsComplete() const { return datum == VerticalDatum::kEllipsoid && attitude && hfov_rad; }
};

}  // namespace victorious

// The camera's position, attitude and field of view at one moment of a video. Made by telemetry/.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "victorious/geometry/attitude.h"
#include "victorious/geometry/geodesy.h"
#include "victorious/types/vertical_datum.h"

namespace victorious {

/// How one standard deviation of an error of telemetry's clock moves and turns the camera.
struct ClockError {
  Eigen::Vector3d moved_enu_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d turned_enu_rad = Eigen::Vector3d::Zero();  ///< axis times angle
};

struct CameraState {
  double time_s = 0;    ///< seconds since the video's first frame
  GeodeticPoint place;  ///< the centre of projection, WGS 84; its altitude refers to `datum`
  VerticalDatum datum = VerticalDatum::kEllipsoid;  ///< another one only if conversion to the ellipsoid is impossible
  std::optional<Attitude> attitude;                 ///< of the camera, relative to north and the vertical at `place`
  std::optional<double> hfov_rad;                   ///< full horizontal field of view, (0, pi)
  std::optional<double> sigma_position_m;           ///< standard deviation along each axis
  std::optional<double> sigma_attitude_rad;         ///< standard deviation about each axis
  std::optional<std::int64_t> utc_us;               ///< microseconds since 1970-01-01 UTC
  std::optional<ClockError> clock_error;            ///< one error in all states of a flight; std::nullopt: none known
  std::optional<double> sigma_focal;                ///< of the focal length's logarithm; one error in all states
  std::optional<std::array<double, 5>> distortion;  ///< k1, k2, p1, p2, k3 in OpenCV's model and order

  /// True if lines of sight of this camera can be georeferenced: ellipsoidal height, attitude and field of view known.
  [[nodiscard]] bool IsComplete() const { return datum == VerticalDatum::kEllipsoid && attitude && hfov_rad; }
};

}  // namespace victorious

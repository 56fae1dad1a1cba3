#include "victorious/simulate/telemetry.h"

#include <fmt/format.h>

#include "victorious/geometry/angles.h"
#include "victorious/simulate/truth.h"

namespace victorious {

CameraOnEarth CameraOnEarthOf(const Rigid3& camera_from_town, const TangentPlane& earth, double town_heading_rad) {
  const Eigen::Quaterniond enu_from_town = EnuFromTown(town_heading_rad);
  const Eigen::Vector3d place_in_enu = enu_from_town * camera_from_town.Inverse().translation;
  const Eigen::Quaterniond camera_from_enu = camera_from_town.rotation * enu_from_town.conjugate();
  const Eigen::Quaterniond camera_from_local = camera_from_enu * earth.LocalEnuFromEnu(place_in_enu).conjugate();
  return {earth.GeodeticFromEnu(place_in_enu), AttitudeOf(camera_from_local)};
}

std::string TelemetryRow(const CameraOnEarth& camera, double time_s, double hfov_deg) {
  return fmt::format("{:.6f},{:.10f},{:.10f},{:.4f},{:.6f},{:.6f},{:.6f},{:.6f}\n", time_s,
                     DegreesFromRadians(camera.place.latitude_rad), DegreesFromRadians(camera.place.longitude_rad),
                     camera.place.altitude_m, DegreesFromRadians(camera.attitude.yaw_rad),
                     DegreesFromRadians(camera.attitude.pitch_rad), DegreesFromRadians(camera.attitude.roll_rad),
                     hfov_deg);
}

}  // namespace victorious

#include "victorious/lab/simulate/telemetry.h"

#include "victorious/lab/simulate/truth.h"

namespace victorious {

CameraState MakeCameraState(const Rigid3& camera_from_town, const TangentPlane& earth, double town_heading_rad,
                            double time_s, double hfov_rad) {
  const Eigen::Quaterniond enu_from_town = EnuFromTown(town_heading_rad);
  const Eigen::Vector3d place_in_enu = enu_from_town * camera_from_town.Inverse().translation;
  const Eigen::Quaterniond camera_from_enu = camera_from_town.rotation * enu_from_town.conjugate();
  const Eigen::Quaterniond camera_from_local = camera_from_enu * earth.LocalEnuFromEnu(place_in_enu).conjugate();
  CameraState state;
  state.time_s = time_s;
  state.place = earth.GeodeticFromEnu(place_in_enu);
  state.attitude = AttitudeFromRotation(camera_from_local);
  state.hfov_rad = hfov_rad;
  return state;
}

}  // namespace victorious

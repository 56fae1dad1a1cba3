#include "victorious/apps/serve/camera_path.h"

#include "victorious/geometry/attitude.h"
#include "victorious/geometry/camera.h"
#include "victorious/geometry/ground.h"

namespace victorious {

std::optional<Footprint> ComputeFootprint(const CameraState& camera, int width_px, int height_px, double ground_m) {
  constexpr double kMaxDistance_m = 20'000;
  if (!camera.IsComplete() || width_px <= 0 || height_px <= 0) return std::nullopt;
  const PinholeCamera pinhole = CentredPinhole(*camera.hfov_rad, width_px, height_px);
  const Eigen::Quaterniond enu_from_camera = CameraFromEnu(*camera.attitude).inverse();
  const TangentPlane plane(camera.place);
  const FlatGround ground(ground_m);
  const double right = width_px;
  const double bottom = height_px;
  const std::array<Eigen::Vector2d, 4> corners = {Eigen::Vector2d(0, 0), {right, 0}, {right, bottom}, {0, bottom}};
  Footprint footprint;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector3d along = (enu_from_camera * pinhole.Unproject(corners[i])).normalized();
    const auto patch = IntersectGround(ground, plane, Eigen::Vector3d::Zero(), along, 0);
    if (!patch || patch->point.norm() > kMaxDistance_m) return std::nullopt;
    footprint[i] = plane.GeodeticFromEnu(patch->point);
  }
  return footprint;
}

std::vector<CameraState> ThinStates(const std::vector<CameraState>& states, std::size_t max_points) {
  if (states.size() <= max_points || max_points < 2) return states;
  std::vector<CameraState> thinned;
  const double first_s = states.front().time_s;
  const double step_s = (states.back().time_s - first_s) / static_cast<double>(max_points - 1);
  for (const CameraState& state : states) {
    const bool is_due = state.time_s >= first_s + step_s * static_cast<double>(thinned.size()) - 1e-9;
    if (is_due || &state == &states.back()) thinned.push_back(state);
  }
  if (thinned.size() > max_points) thinned.erase(thinned.end() - 2);
  return thinned;
}

CameraPath MakeCameraPath(const std::vector<CameraState>& states, CameraPathSource source, int width_px, int height_px,
                          std::optional<double> ground_m) {
  CameraPath path{.source = source, .reason = {}, .ground_m = ground_m, .points = {}};
  bool has_footprint = false;
  for (const CameraState& state : states) {
    CameraPathPoint point{.time_s = state.time_s, .place = state.place, .yaw_rad = {}, .footprint = {}};
    if (state.attitude) point.yaw_rad = state.attitude->yaw_rad;
    if (ground_m) point.footprint = ComputeFootprint(state, width_px, height_px, *ground_m);
    has_footprint |= point.footprint.has_value();
    path.points.push_back(point);
  }
  if (path.points.empty() || has_footprint) return path;
  path.reason = ground_m ? "the camera's attitude, field of view or ellipsoidal height is unknown, or it looks at the "
                           "horizon, so the ground it shows is unknown"
                         : "no object with a place gives the height of the ground, so what the camera shows of it is "
                           "unknown";
  return path;
}

}  // namespace victorious

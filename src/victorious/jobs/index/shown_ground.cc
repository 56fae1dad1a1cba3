#include "victorious/jobs/index/shown_ground.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <optional>

#include "victorious/geometry/attitude.h"
#include "victorious/geometry/camera.h"
#include "victorious/geometry/geodesy.h"

namespace victorious {
namespace {

constexpr double kLowestGround_m = -500;  // lower than the shore of the Dead Sea
constexpr double kMaxDistance_m = 20'000;

GeoBox Around(const GeodeticPoint& point) {
  return {point.latitude_rad, point.longitude_rad, point.latitude_rad, point.longitude_rad};
}

void Grow(GeoBox& box, const GeoBox& other) {
  box = {std::min(box.south_rad, other.south_rad), std::min(box.west_rad, other.west_rad),
         std::max(box.north_rad, other.north_rad), std::max(box.east_rad, other.east_rad)};
}

// The camera, and where the rays of the corners end: what is between them is seen at some height of the ground.
std::optional<GeoBox> ShownBy(const CameraState& camera, int width_px, int height_px) {
  if (!camera.IsComplete() || camera.place.altitude_m <= kLowestGround_m) return std::nullopt;
  const PinholeCamera pinhole = CentredPinhole(*camera.hfov_rad, width_px, height_px);
  const Eigen::Quaterniond enu_from_camera = CameraFromEnu(*camera.attitude).inverse();
  const TangentPlane plane(camera.place);
  const double right = width_px;
  const double bottom = height_px;
  const std::array<Eigen::Vector2d, 4> corners = {Eigen::Vector2d(0, 0), {right, 0}, {right, bottom}, {0, bottom}};
  GeoBox box = Around(camera.place);
  for (const Eigen::Vector2d& corner : corners) {
    const Eigen::Vector3d along = (enu_from_camera * pinhole.Unproject(corner)).normalized();
    if (along.z() >= 0) return std::nullopt;
    const double reach_m = std::min(kMaxDistance_m, (camera.place.altitude_m - kLowestGround_m) / -along.z());
    Grow(box, Around(plane.GeodeticFromEnu(reach_m * along)));
  }
  // Across the antimeridian: all longitudes.
  if (box.east_rad - box.west_rad > std::numbers::pi) {
    box.west_rad = -std::numbers::pi;
    box.east_rad = std::numbers::pi;
  }
  return box;
}

}  // namespace

std::vector<GeoBox> ShownGround(std::span<const CameraState> states, int width_px, int height_px) {
  std::vector<GeoBox> boxes;
  if (width_px <= 0 || height_px <= 0) return boxes;
  const std::size_t length = (states.size() + kMaxShownGroundBoxes - 1) / kMaxShownGroundBoxes;
  for (std::size_t first = 0; first < states.size(); first += length) {
    std::optional<GeoBox> shown;
    for (const CameraState& state : states.subspan(first, std::min(length, states.size() - first))) {
      const std::optional<GeoBox> one = ShownBy(state, width_px, height_px);
      if (!one) continue;
      if (!shown) shown = *one;
      Grow(*shown, *one);
    }
    if (shown) boxes.push_back(*shown);
  }
  return boxes;
}

}  // namespace victorious

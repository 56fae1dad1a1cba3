#include "victorious/render/view_sphere.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

using Eigen::Vector3d;

// A grid of rings of views; the pole stands before them.
struct Grid {
  int rings = 0;
  int around = 0;

  [[nodiscard]] int Index(int ring, int place) const { return 1 + ring * around + (place + around) % around; }

  [[nodiscard]] std::vector<int> NeighboursOf(int ring, int place) const {
    std::vector<int> neighbours;
    for (int r = std::max(ring - 1, 0); r <= std::min(ring + 1, rings - 1); ++r) {
      for (int p = place - 1; p <= place + 1; ++p) neighbours.push_back(Index(r, p));
    }
    if (ring == 0) neighbours.push_back(0);
    std::ranges::sort(neighbours);
    const auto doubled = std::ranges::unique(neighbours);  // rings of one or two views
    neighbours.erase(doubled.begin(), doubled.end());
    std::erase(neighbours, Index(ring, place));
    return neighbours;
  }

  [[nodiscard]] std::vector<int> NeighboursOfPole() const {
    std::vector<int> neighbours;
    for (int place = 0; rings > 0 && place < around; ++place) neighbours.push_back(Index(0, place));
    return neighbours;
  }
};

// Upwards in the image: the direction in which off-nadir grows less, as seen from the camera.
Vector3d ImageUp(const ViewDirection& direction) {
  const double c = std::cos(direction.off_nadir_rad);
  return {c * std::cos(direction.azimuth_rad), -c * std::sin(direction.azimuth_rad), std::sin(direction.off_nadir_rad)};
}

}  // namespace

void ViewSphereOptions::ListFields(FieldList& fields) {
  fields.Add(
      "step", step_deg,
      {.min = 1, .max = 90, .unit = "deg", .reason = "between views; features bear some 10 degrees of turn well"});
  fields.Add(
      "max_off_nadir", max_off_nadir_deg,
      {.min = 0, .max = 180, .unit = "deg", .reason = "the flattest view; a camera in the air sees no flatter ones"});
}

Expected<ViewSphere> MakeViewSphere(const ViewSphereOptions& options) {
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
  constexpr double kTolerance = 1e-9;
  const double around = 360.0 / options.step_deg;
  if (std::abs(around - std::round(around)) > kTolerance) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("step {} degrees: one that divides 360 is right", options.step_deg));
  }
  const double below = options.max_off_nadir_deg < 180.0 ? options.max_off_nadir_deg : 180.0 - options.step_deg;
  const Grid grid{.rings = static_cast<int>(below / options.step_deg + kTolerance),
                  .around = static_cast<int>(std::lround(around))};
  ViewSphere sphere;
  sphere.views.push_back({{}, grid.NeighboursOfPole()});
  for (int ring = 0; ring < grid.rings; ++ring) {
    for (int place = 0; place < grid.around; ++place) {
      const ViewDirection direction{.azimuth_rad = RadiansFromDegrees(place * options.step_deg),
                                    .off_nadir_rad = RadiansFromDegrees((ring + 1) * options.step_deg)};
      sphere.views.push_back({direction, grid.NeighboursOf(ring, place)});
    }
  }
  return sphere;
}

Vector3d DirectionToCamera(const ViewDirection& direction) {
  const double s = std::sin(direction.off_nadir_rad);
  return {-s * std::cos(direction.azimuth_rad), s * std::sin(direction.azimuth_rad), std::cos(direction.off_nadir_rad)};
}

ViewDirection DirectionFromVector(const Vector3d& object_to_camera) {
  const double sideways = std::hypot(object_to_camera.x(), object_to_camera.y());
  const double azimuth = sideways > 0 ? std::atan2(object_to_camera.y(), -object_to_camera.x()) : 0.0;
  return {.azimuth_rad = azimuth < 0 ? azimuth + 2 * kPi : azimuth,
          .off_nadir_rad = std::atan2(sideways, object_to_camera.z())};
}

Eigen::Quaterniond CameraFromModel(const ViewDirection& direction) {
  const Vector3d to_camera = DirectionToCamera(direction);
  const Vector3d up = ImageUp(direction);
  Eigen::Matrix3d rotation;
  rotation << up.cross(to_camera).transpose(), -up.transpose(), -to_camera.transpose();
  return Eigen::Quaterniond(rotation);
}

Expected<PosedCamera> CameraForView(const ViewDirection& direction, const Sphere& sphere, const ViewFraming& framing) {
  if (!(sphere.radius > 0) || !(framing.distance_m > sphere.radius)) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("distance {} m to the middle of an object of radius {} m: more than "
                            "its radius is right",
                            framing.distance_m, sphere.radius));
  }
  if (!(framing.diameter_px > 0) || framing.width_px < 1 || framing.height_px < 1) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("an object of {} px in an image of {} x {}: sizes above 0 are right", framing.diameter_px,
                            framing.width_px, framing.height_px));
  }
  const double grazing = std::sqrt(framing.distance_m * framing.distance_m - sphere.radius * sphere.radius);
  const double focal_px = framing.diameter_px / 2 * grazing / sphere.radius;

  const Eigen::Quaterniond camera_from_model = CameraFromModel(direction);
  const Vector3d eye = sphere.centre + framing.distance_m * DirectionToCamera(direction);
  return PosedCamera{.pinhole = {.fx = focal_px,
                                 .fy = focal_px,
                                 .cx = framing.width_px / 2.0,
                                 .cy = framing.height_px / 2.0,
                                 .width = framing.width_px,
                                 .height = framing.height_px},
                     .camera_from_world = {camera_from_model, -(camera_from_model * eye)}};
}

}  // namespace victorious

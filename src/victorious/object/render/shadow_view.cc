#include "victorious/object/render/shadow_view.h"

#include <algorithm>
#include <array>
#include <limits>

#include "victorious/object/render/frustum.h"

namespace victorious {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

using Corners = std::vector<Vector3d>;

Vector3d BoxCorner(const AlignedBox3d& box, int corner) {
  return box.corner(static_cast<AlignedBox3d::CornerType>(corner));
}

// Clips a convex polygon to the positive side of a plane through the origin (Sutherland and Hodgman).
Corners ClipToHalfSpace(const Corners& polygon, const Vector3d& normal) {
  Corners kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector3d& from = polygon[i];
    const Vector3d& to = polygon[(i + 1) % polygon.size()];
    const double a = normal.dot(from);
    const double b = normal.dot(to);
    if (a >= 0) kept.push_back(from);
    if ((a > 0 && b < 0) || (a < 0 && b > 0)) kept.push_back(from + a / (a - b) * (to - from));
  }
  return kept;
}

// The corners, in the camera frame, of the part of a box inside the frustum: the vertices of its clipped faces, and the
// camera centre if it is inside the box.
Corners VisiblePart(const AlignedBox3d& box, const Rigid3& camera_from_box, const PinholeCamera& camera) {
  constexpr std::array<std::array<int, 4>, 6> kFaces = {
      {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}}};
  Corners seen;
  for (const auto& face : kFaces) {
    Corners polygon;
    for (const int corner : face) polygon.push_back(camera_from_box.Apply(BoxCorner(box, corner)));
    for (const Vector3d& side : FrustumNormals(camera)) polygon = ClipToHalfSpace(polygon, side);
    seen.insert(seen.end(), polygon.begin(), polygon.end());
  }
  if (box.contains(camera_from_box.Inverse().translation)) seen.emplace_back(0, 0, 0);
  return seen;
}

// The sun frame. Its x axis lies along the image's x axis, so that the visible region fills most of its bounding
// rectangle.
Rigid3 SunFromWorld(const PosedCamera& camera, const Vector3d& to_sun_in_world) {
  const Vector3d z = -to_sun_in_world.normalized();
  const Rigid3 world_from_camera = camera.camera_from_world.Inverse();
  Vector3d along = world_from_camera.rotation * Vector3d::UnitX();
  if (along.cross(z).norm() < 0.1) along = world_from_camera.rotation * Vector3d::UnitY();
  const Vector3d y = z.cross(along).normalized();
  Eigen::Matrix3d rotation;
  rotation << y.cross(z).transpose(), y.transpose(), z.transpose();
  // The origin is the camera, so that coordinates stay small if the world's origin is far away.
  const Eigen::Quaterniond turn(rotation);
  return {turn, -(turn * world_from_camera.translation)};
}

}  // namespace

std::optional<ShadowView> FitShadowView(std::span<const PlacedBox> boxes, const PosedCamera& camera,
                                        const Vector3d& to_sun_in_world, double margin_m) {
  ShadowView view{.sun_from_world = SunFromWorld(camera, to_sun_in_world), .box_in_sun = {}, .casts_shadow = {}};
  const Rigid3 sun_from_camera = view.sun_from_world * camera.camera_from_world.Inverse();
  std::vector<AlignedBox3d> in_sun(boxes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const auto& [box, world_from_box] = boxes[i];
    if (box.isEmpty()) continue;
    const Rigid3 sun_from_box = view.sun_from_world * world_from_box;
    for (int corner = 0; corner < 8; ++corner) in_sun[i].extend(sun_from_box.Apply(BoxCorner(box, corner)));
    for (const Vector3d& point : VisiblePart(box, camera.camera_from_world * world_from_box, camera.pinhole)) {
      view.box_in_sun.extend(sun_from_camera.Apply(point));
    }
  }
  if (view.box_in_sun.isEmpty()) return std::nullopt;
  AlignedBox3d& seen = view.box_in_sun;
  seen.min() -= Vector3d::Constant(margin_m);
  seen.max() += Vector3d::Constant(margin_m);
  AlignedBox3d shading = seen;
  shading.min().z() = -std::numeric_limits<double>::infinity();
  for (const AlignedBox3d& box : in_sun) {
    view.casts_shadow.push_back(shading.intersects(box));
    if (view.casts_shadow.back()) seen.min().z() = std::min(seen.min().z(), box.min().z() - margin_m);
  }
  return view;
}

}  // namespace victorious

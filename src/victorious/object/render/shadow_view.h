// Private to render/: fits the parallel projection of the shadow map to the region that the camera sees. Sun frame: z
// along the sun's rays (away from the sun), metres.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "victorious/geometry/camera.h"
#include "victorious/geometry/rigid3.h"

namespace victorious {

/// An oriented bounding box: axis-aligned in the frame of a mesh, placed in the world.
struct PlacedBox {
  Eigen::AlignedBox3d box;
  Rigid3 world_from_box;
};

struct ShadowView {
  Rigid3 sun_from_world;
  Eigen::AlignedBox3d box_in_sun;  ///< in x and y: bounds of the visible geometry; in z: also of its shadow casters
  std::vector<bool> casts_shadow;  ///< for each box of the input, whether it may cast a shadow on visible geometry
};

/// Clips the boxes to the camera frustum (Sutherland and Hodgman) and bounds the result in the sun frame.
/// @param margin_m  margin around the bounds on every side, m
/// @return std::nullopt if the camera sees none of the boxes
std::optional<ShadowView> FitShadowView(std::span<const PlacedBox> boxes, const PosedCamera& camera,
                                        const Eigen::Vector3d& to_sun_in_world, double margin_m);

}  // namespace victorious

// Private to render/: how the sun sees what the camera sees. Sun frame: z along the sun's rays, metres.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "victorious/geometry/camera.h"
#include "victorious/geometry/rigid3.h"

namespace victorious {

/// A box of a mesh's own frame that stands somewhere.
struct PlacedBox {
  Eigen::AlignedBox3d box;
  Rigid3 world_from_box;
};

struct ShadowView {
  Rigid3 sun_from_world;
  Eigen::AlignedBox3d box_in_sun;  ///< across the rays: all that is seen; along them: also all that shades it
  std::vector<bool> casts;         ///< for each placed box, whether it may shade what is seen
};

/// @param margin_m  how far beyond what is seen the view goes, across the rays
/// Nothing where the camera sees none of the boxes.
std::optional<ShadowView> FitShadowView(std::span<const PlacedBox> boxes, const PosedCamera& camera,
                                        const Eigen::Vector3d& to_sun_in_world, double margin_m);

}  // namespace victorious

// A point of an object's surface, from a rendering with depth (render/relight.h); the shape search draws its templates
// of such points (shape/surface_template.h).
#pragma once

#include <vector>

#include <Eigen/Core>

namespace victorious {

struct SurfacePoint {
  Eigen::Vector3f position_m = Eigen::Vector3f::Zero();  ///< model axes
  Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();     ///< unit vector, model axes
  float albedo = 0.5F;                                   ///< linear, 0 to 1
};

/// What is seen of a surface from one direction. Positions are relative to the centre of the object's bounding box.
struct VisibleSurface {
  std::vector<SurfacePoint> points;
  double spacing_m = 0;  ///< between neighbouring points, across the direction
};

}  // namespace victorious

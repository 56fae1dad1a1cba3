// Points of an object's surface, from a rendering with depth (object/render/relight.h): the shape search draws its
// templates of such points (search/shape/surface_template.h), and the search by contours fits the edges
// (search/recognize/contour_pose.h).
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

/// A point of an edge as seen from one direction: of the outline, of a step in depth, or of a crease. Positions are
/// relative to the centre of the object's bounding box, model axes.
struct ContourPoint {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d beside_m = Eigen::Vector3d::Zero();  ///< another point of the tangent
};

}  // namespace victorious

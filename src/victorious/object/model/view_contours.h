// The edges that a rendering with depth shows: the outline, steps in depth, and creases between two planes. The search
// by contours (search/recognize/contour_search.h) fits them to an image.
//
// Inverse depth w is linear in the image of a plane. Between two neighbouring pixels lies
//   an outline or a step  where one has no depth, or the depth differs by 3 % of the object's size from what both sides
//                         extrapolate; the point belongs to the nearer surface
//   a crease              where the two planes meet between the pixels at an angle of 29 degrees or more
// The points of a neighbourhood are fitted by a line: a pixel's rounding averages out. Corners, where no line fits,
// have no points.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "victorious/object/render/relight.h"
#include "victorious/types/surface_point.h"

namespace victorious {

/// @param centre_m    centre of the object's bounding box, world frame of `depth_map`
/// @param diagonal_m  of the bounding box
/// @return points about 1 / 70 of the object's size apart
[[nodiscard]] std::vector<ContourPoint> ReadContours(const PosedDepthMap& depth_map, const Eigen::Vector3d& centre_m,
                                                     double diagonal_m);

}  // namespace victorious

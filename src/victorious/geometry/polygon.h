// Simple polygons in pixels: object outlines, clipping, and intersection over union.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "victorious/geometry/box.h"

namespace victorious {

/// Corners in order (either orientation), finite, without repetitions.
using Polygon = std::vector<Eigen::Vector2d>;

/// Signed area: positive if the corners turn from +x towards +y (clockwise on the screen).
double SignedArea(const Polygon& polygon);

/// The bounding box of the corners; empty for no corners.
Box BoundingBox(const Polygon& polygon);

/// The box's four corners, from the top left, clockwise on the screen.
Polygon BoxCorners(const Box& box);

/// The part of `subject` inside the convex polygon `clip` (Sutherland and Hodgman 1974); empty if `clip` has no area.
/// O(n m).
Polygon ClipToConvex(const Polygon& subject, const Polygon& clip);

/// The part of `subject` inside a box.
Polygon ClipToBox(const Polygon& subject, const Box& box);

/// The fraction of the area that is inside a box; 0 for a polygon without area.
double FractionInside(const Polygon& subject, const Box& box);

/// True if all turns have the same sense and the outline winds once; false if it has no area or is not finite.
bool IsConvex(const Polygon& polygon);

/// The convex hull, clockwise on the screen (Andrew's monotone chain). O(n log n).
Polygon ConvexHull(std::vector<Eigen::Vector2d> points);

/// Intersection over union of two outlines, 0 to 1. `b` must be convex.
double IntersectionOverUnion(const Polygon& a, const Polygon& b);

}  // namespace victorious

// Simple polygons in pixels: an object's outline, and how much two outlines agree.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "victorious/geometry/box.h"

namespace victorious {

/// Corners in order (either sense), finite, none repeated.
using Polygon = std::vector<Eigen::Vector2d>;

/// Signed area: positive when the corners turn from +x towards +y (clockwise on the screen).
double SignedArea(const Polygon& polygon);

/// The smallest box around the corners; empty for no corners.
Box BoundingBox(const Polygon& polygon);

/// The box's four corners, from the left top, clockwise on the screen.
Polygon CornersOf(const Box& box);

/// The part of `subject` inside the convex polygon `clip` (Sutherland and Hodgman 1974); nothing is inside a clip
/// without area. O(n m).
Polygon ClipToConvex(const Polygon& subject, const Polygon& clip);

/// The part inside a box.
Polygon ClipToBox(const Polygon& subject, const Box& box);

/// The share of its area that is inside a box; 0 of what has no area.
double ShareInside(const Polygon& subject, const Box& box);

/// True if all turns are in one sense and the outline goes round once; false for what has no area or is not finite.
bool IsConvex(const Polygon& polygon);

/// The convex hull, clockwise on the screen (Andrew's monotone chain). O(n log n).
Polygon ConvexHull(std::vector<Eigen::Vector2d> points);

/// Intersection over union of two outlines, 0 to 1. `b` must be convex.
double IntersectionOverUnion(const Polygon& a, const Polygon& b);

}  // namespace victorious

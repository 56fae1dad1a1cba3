// Meshes made of lofts, extrusions and revolutions, in the axes of glTF: metres, Y up, front along +Z, so +X is the
// left side. Every shape here is closed and its triangles run counter-clockwise seen from outside.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace victorious::assets {

using Vec3 = Eigen::Vector3f;
using Ring = std::vector<Vec3>;                ///< a closed outline in space
using Polygon = std::vector<Eigen::Vector2f>;  ///< a closed outline in a plane, either way round

enum class Axis { kX, kY, kZ };

struct Mesh {
  std::vector<Vec3> points;
  std::vector<std::array<int, 3>> triangles;

  Mesh& Add(const Mesh& other);
  Mesh& Add(const Mesh& other, const Eigen::Affine3f& place);
  /// Adds `other` and its mirror image across the plane x = 0.
  Mesh& AddBothSides(const Mesh& other);
};

// --- Where things stand ----------------------------------------------------------------------------------------------

Eigen::Affine3f At(float x, float y, float z);
Eigen::Affine3f Turn(Axis axis, float degrees);
Mesh Moved(Mesh mesh, const Eigen::Affine3f& place);
/// The mirror image across x = 0, facing outwards again.
Mesh Mirrored(Mesh mesh);
Mesh Bent(Mesh mesh, const std::function<Vec3(const Vec3&)>& map);

// --- Outlines --------------------------------------------------------------------------------------------------------

Polygon Rectangle(float a0, float b0, float a1, float b1);
/// The corners cut round by arcs of `radius`, in `steps` pieces; less where an edge is too short for it.
Polygon Rounded(const Polygon& outline, float radius, int steps = 3);
/// `steps` points on the arc about a centre, from one angle to another.
Polygon Arc(float a, float b, float radius, float from_deg, float to_deg, int steps);
/// A superellipse across the z axis: power 2 is an ellipse, 4 nearly a box. Upper and lower half heights may differ.
struct SectionShape {
  float z = 0;
  float y = 0;  ///< of its widest place
  float half_width = 1;
  float up = 1;
  float down = 1;
  float power = 2;
  float x = 0;
};
Ring Section(const SectionShape& shape, int points = 20);

// --- Solids ----------------------------------------------------------------------------------------------------------

/// A skin over rings of equal length, closed at both ends by flat caps (which may be concave).
Mesh Loft(const std::vector<Ring>& rings);
/// An outline pulled along an axis. Its plane's coordinates are (z, y) for kX, (z, x) for kY, (x, y) for kZ.
/// @param bevel  width of the chamfer about both ends
Mesh Extrude(const Polygon& outline, Axis axis, float from, float to, float bevel = 0);
/// A box with chamfered edges.
Mesh Box(const Vec3& centre, const Vec3& size, float bevel = 0.02F);
/// A profile of (along the axis, radius) turned about it; it starts and ends on the axis or is closed by flat ends.
Mesh Revolve(const Polygon& profile, Axis axis, int segments);
Mesh Cylinder(const Vec3& from, const Vec3& to, float radius, int segments = 10);
/// A round bar along a path.
Mesh Tube(const std::vector<Vec3>& path, float radius, int segments = 6);
Mesh Ball(const Vec3& centre, const Vec3& radii, int segments = 12);

/// A place along a wing: its chord runs from the leading edge backwards (-z).
struct WingSection {
  Vec3 leading_edge;
  float chord = 1;
  float thickness = 0.1F;  ///< m, of the thickest place
};
/// A wing through its sections. `up` is the side the thickness lies along: Y for a wing, X for a fin.
Mesh Wing(const std::vector<WingSection>& sections, const Vec3& up = Vec3::UnitY());

/// The corners' normals, smooth where faces meet at less than `crease_deg`. One a corner, three a triangle.
std::vector<Vec3> CornerNormals(const Mesh& mesh, float crease_deg = 38);

}  // namespace victorious::assets

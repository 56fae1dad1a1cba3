// tools/: meshes from lofts, extrusions and revolutions, in glTF axes: metres, Y up, front along +Z, so +X is the left
// side. Every mesh here is closed; its triangles are counter-clockwise seen from outside.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace victorious::assets {

using Vec3 = Eigen::Vector3f;
using Ring = std::vector<Vec3>;                ///< a closed 3D outline
using Polygon = std::vector<Eigen::Vector2f>;  ///< a closed 2D outline of either orientation

enum class Axis { kX, kY, kZ };

struct Mesh {
  std::vector<Vec3> points;
  std::vector<std::array<int, 3>> triangles;

  Mesh& Add(const Mesh& other);
  Mesh& Add(const Mesh& other, const Eigen::Affine3f& place);
  /// Adds `other` and its mirror image across the plane x = 0.
  Mesh& AddBothSides(const Mesh& other);
};

// --- Transforms ----------------------------------------------------------------------------------------------

Eigen::Affine3f At(float x, float y, float z);
Eigen::Affine3f Turn(Axis axis, float degrees);
Mesh Moved(Mesh mesh, const Eigen::Affine3f& place);
/// The mirror image across x = 0, facing outwards again.
Mesh Mirrored(Mesh mesh);
Mesh Bent(Mesh mesh, const std::function<Vec3(const Vec3&)>& map);

// --- Outlines --------------------------------------------------------------------------------------------------------

Polygon Rectangle(float a0, float b0, float a1, float b1);
/// The outline with corners rounded by arcs of `radius` in `steps` segments; a smaller radius at short edges.
Polygon Rounded(const Polygon& outline, float radius, int steps = 3);
/// `steps` points on an arc around (a, b), from one angle to another.
Polygon Arc(float a, float b, float radius, float from_deg, float to_deg, int steps);
/// A superellipse across the z axis: power 2 is an ellipse, 4 nearly a box. Upper and lower half heights may differ.
struct SectionShape {
  float z = 0;
  float y = 0;  ///< of the widest point
  float half_width = 1;
  float up = 1;
  float down = 1;
  float power = 2;
  float x = 0;
};
Ring Section(const SectionShape& shape, int points = 20);

// --- Solids ----------------------------------------------------------------------------------------------------------

/// A surface through rings of equal size, closed at both ends by flat caps (which may be concave).
Mesh Loft(const std::vector<Ring>& rings);
/// An outline extruded along an axis. Its plane's coordinates are (z, y) for kX, (z, x) for kY, (x, y) for kZ.
/// @param bevel  width of the chamfer at both ends
Mesh Extrude(const Polygon& outline, Axis axis, float from, float to, float bevel = 0);
/// A box with chamfered edges.
Mesh Box(const Vec3& centre, const Vec3& size, float bevel = 0.02F);
/// A profile of points (along the axis, radius) revolved around the axis; ends off the axis are closed by flat caps.
Mesh Revolve(const Polygon& profile, Axis axis, int segments);
Mesh Cylinder(const Vec3& from, const Vec3& to, float radius, int segments = 10);
/// A round bar along a path.
Mesh Tube(const std::vector<Vec3>& path, float radius, int segments = 6);
Mesh Ball(const Vec3& centre, const Vec3& radii, int segments = 12);

/// A cross-section of a wing: the chord runs from the leading edge backwards (-z).
struct WingSection {
  Vec3 leading_edge;
  float chord = 1;
  float thickness = 0.1F;  ///< maximum thickness, m
};
/// A wing through its sections. `up` is the direction of the thickness: Y for a wing, X for a fin.
Mesh Wing(const std::vector<WingSection>& sections, const Vec3& up = Vec3::UnitY());

/// Normals per triangle corner (three per triangle), smooth across edges whose faces meet at less than `crease_deg`.
std::vector<Vec3> CornerNormals(const Mesh& mesh, float crease_deg = 38);

}  // namespace victorious::assets

#include "assets/make/mesh.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <numbers>
#include <tuple>
#include <utility>

namespace victorious::assets {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

float Radians(float degrees) { return degrees * kPi / 180; }

float Cross(const Eigen::Vector2f& a, const Eigen::Vector2f& b) { return a.x() * b.y() - a.y() * b.x(); }

float SignedArea(const Polygon& outline) {
  float area = 0;
  for (std::size_t i = 0; i < outline.size(); ++i) area += Cross(outline[i], outline[(i + 1) % outline.size()]);
  return area / 2;
}

Polygon CounterClockwise(Polygon outline) {
  if (SignedArea(outline) < 0) std::ranges::reverse(outline);
  return outline;
}

/// The outline moved inwards by `distance` along the bisectors of its corners.
Polygon Inset(const Polygon& outline, float distance) {
  const std::size_t count = outline.size();
  Polygon inset(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector2f before = (outline[i] - outline[(i + count - 1) % count]).normalized();
    const Eigen::Vector2f after = (outline[(i + 1) % count] - outline[i]).normalized();
    const Eigen::Vector2f normal_before(-before.y(), before.x());
    const Eigen::Vector2f normal_after(-after.y(), after.x());
    const Eigen::Vector2f bisector = normal_before + normal_after;
    const float stretch = std::max(0.35F, bisector.squaredNorm() / 2);
    inset[i] = outline[i] + bisector * (distance / stretch);
  }
  return inset;
}

bool InTriangle(const Eigen::Vector2f& p, const Eigen::Vector2f& a, const Eigen::Vector2f& b,
                const Eigen::Vector2f& c) {
  return Cross(b - a, p - a) >= 0 && Cross(c - b, p - b) >= 0 && Cross(a - c, p - c) >= 0;
}

/// Triangulates a simple polygon by ear clipping. Indices into `outline`, counter-clockwise.
std::vector<std::array<int, 3>> CutEars(const Polygon& outline) {
  std::vector<int> left(outline.size());
  for (std::size_t i = 0; i < left.size(); ++i) left[i] = static_cast<int>(i);
  if (SignedArea(outline) < 0) std::ranges::reverse(left);
  std::vector<std::array<int, 3>> triangles;
  while (left.size() > 3) {
    const std::size_t count = left.size();
    std::size_t best = 0;
    float best_quality = -2;
    for (std::size_t i = 0; i < count; ++i) {
      const int before = left[(i + count - 1) % count];
      const int after = left[(i + 1) % count];
      const Eigen::Vector2f &a = outline[before], &b = outline[left[i]], &c = outline[after];
      if (Cross(b - a, c - b) <= 0) continue;
      const bool empty = std::ranges::none_of(left, [&](int other) {
        if (other == before || other == left[i] || other == after) return false;
        const Eigen::Vector2f& p = outline[other];
        return p != a && p != b && p != c && InTriangle(p, a, b, c);
      });
      const float longest = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
      const float quality = (empty ? 0.0F : -1.0F) + std::min(0.9F, Cross(b - a, c - b) / longest);
      if (quality > best_quality) {
        best_quality = quality;
        best = i;
      }
    }
    triangles.push_back({left[(best + count - 1) % count], left[best], left[(best + 1) % count]});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(best));
  }
  triangles.push_back({left[0], left[1], left[2]});
  return triangles;
}

/// Triangulates a planar or nearly planar ring.
std::vector<std::array<int, 3>> CapTriangles(const Ring& ring) {
  Vec3 normal = Vec3::Zero();
  for (std::size_t i = 0; i < ring.size(); ++i) normal += ring[i].cross(ring[(i + 1) % ring.size()]);
  if (normal.norm() < 1e-9F) return {};
  normal.normalize();
  const Vec3 right = normal.unitOrthogonal();
  const Vec3 up = normal.cross(right);
  Polygon flat;
  for (const Vec3& point : ring) flat.emplace_back(point.dot(right), point.dot(up));
  return CutEars(flat);
}

float Volume(const Mesh& mesh) {
  float volume = 0;
  for (const auto& [a, b, c] : mesh.triangles) volume += mesh.points[a].dot(mesh.points[b].cross(mesh.points[c]));
  return volume;
}

Mesh FacingOutwards(Mesh mesh) {
  // Relative to its centroid, for precision far from the origin.
  Vec3 middle = Vec3::Zero();
  for (const Vec3& point : mesh.points) middle += point / static_cast<float>(mesh.points.size());
  if (Volume(Moved(mesh, Eigen::Affine3f(Eigen::Translation3f(-middle)))) < 0) {
    for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  }
  return mesh;
}

Vec3 InSpace(const Eigen::Vector2f& point, Axis axis, float along) {
  switch (axis) {
    case Axis::kX:
      return {along, point.y(), point.x()};
    case Axis::kY:
      return {point.y(), along, point.x()};
    case Axis::kZ:
      break;
  }
  return {point.x(), point.y(), along};
}

Vec3 Unit(Axis axis) { return Vec3::Unit(static_cast<int>(axis)); }

Ring Circle(const Vec3& centre, const Vec3& direction, float radius, int segments) {
  const Vec3 right = direction.unitOrthogonal();
  const Vec3 up = direction.cross(right);
  Ring ring;
  for (int i = 0; i < segments; ++i) {
    const float angle = 2 * kPi * (static_cast<float>(i) + 0.5F) / static_cast<float>(segments);
    ring.push_back(centre + radius * (std::cos(angle) * right + std::sin(angle) * up));
  }
  return ring;
}

}  // namespace

Mesh& Mesh::Add(const Mesh& other) {
  const int first = static_cast<int>(points.size());
  points.insert(points.end(), other.points.begin(), other.points.end());
  for (const auto& [a, b, c] : other.triangles) triangles.push_back({first + a, first + b, first + c});
  return *this;
}

Mesh& Mesh::Add(const Mesh& other, const Eigen::Affine3f& place) { return Add(Moved(other, place)); }

Mesh& Mesh::AddBothSides(const Mesh& other) { return Add(other).Add(Mirrored(other)); }

Eigen::Affine3f At(float x, float y, float z) { return Eigen::Affine3f(Eigen::Translation3f(x, y, z)); }

Eigen::Affine3f Turn(Axis axis, float degrees) {
  return Eigen::Affine3f(Eigen::AngleAxisf(Radians(degrees), Unit(axis)));
}

Mesh Moved(Mesh mesh, const Eigen::Affine3f& place) {
  for (Vec3& point : mesh.points) point = place * point;
  return mesh;
}

Mesh Mirrored(Mesh mesh) {
  for (Vec3& point : mesh.points) point.x() = -point.x();
  for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  return mesh;
}

Mesh Bent(Mesh mesh, const std::function<Vec3(const Vec3&)>& map) {
  for (Vec3& point : mesh.points) point = map(point);
  return mesh;
}

Polygon Rectangle(float a0, float b0, float a1, float b1) { return {{a0, b0}, {a1, b0}, {a1, b1}, {a0, b1}}; }

Polygon Rounded(const Polygon& outline, float radius, int steps) {
  const std::size_t count = outline.size();
  Polygon rounded;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector2f& corner = outline[i];
    const Eigen::Vector2f before = outline[(i + count - 1) % count] - corner;
    const Eigen::Vector2f after = outline[(i + 1) % count] - corner;
    const float reach = std::min({radius, 0.45F * before.norm(), 0.45F * after.norm()});
    const Eigen::Vector2f from = corner + before.normalized() * reach;
    const Eigen::Vector2f to = corner + after.normalized() * reach;
    for (int step = 0; step <= steps; ++step) {  // a parabola from edge to edge
      const float t = static_cast<float>(step) / static_cast<float>(steps);
      rounded.push_back((1 - t) * (1 - t) * from + 2 * t * (1 - t) * corner + t * t * to);
    }
  }
  return rounded;
}

Polygon Arc(float a, float b, float radius, float from_deg, float to_deg, int steps) {
  Polygon arc;
  for (int i = 0; i <= steps; ++i) {
    const float angle = Radians(from_deg + (to_deg - from_deg) * static_cast<float>(i) / static_cast<float>(steps));
    arc.emplace_back(a + radius * std::cos(angle), b + radius * std::sin(angle));
  }
  return arc;
}

Ring Section(const SectionShape& shape, int points) {
  Ring ring;
  const auto bulge = [&](float value) { return std::copysign(std::pow(std::abs(value), 2 / shape.power), value); };
  for (int i = 0; i < points; ++i) {
    const float angle = 2 * kPi * (static_cast<float>(i) + 0.5F) / static_cast<float>(points);
    const float height = bulge(std::sin(angle));
    ring.emplace_back(shape.x + shape.half_width * bulge(std::cos(angle)),
                      shape.y + height * (height > 0 ? shape.up : shape.down), shape.z);
  }
  return ring;
}

Mesh Loft(const std::vector<Ring>& rings) {
  Mesh mesh;
  const int width = static_cast<int>(rings.front().size());
  for (const Ring& ring : rings) mesh.points.insert(mesh.points.end(), ring.begin(), ring.end());
  for (int row = 0; row + 1 < static_cast<int>(rings.size()); ++row) {
    for (int i = 0; i < width; ++i) {
      const int next = (i + 1) % width;
      const int a = row * width + i, b = row * width + next, c = a + width, d = b + width;
      mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({a, d, c});
    }
  }
  const int last = static_cast<int>(mesh.points.size()) - width;
  for (const auto& [a, b, c] : CapTriangles(rings.front())) mesh.triangles.push_back({a, c, b});
  for (const auto& [a, b, c] : CapTriangles(rings.back())) mesh.triangles.push_back({last + a, last + b, last + c});
  std::erase_if(mesh.triangles, [&](const auto& t) {
    const Vec3 &a = mesh.points[t[0]], &b = mesh.points[t[1]], &c = mesh.points[t[2]];
    return (b - a).cross(c - a).norm() < 1e-10F;
  });
  return FacingOutwards(std::move(mesh));
}

Mesh Extrude(const Polygon& outline, Axis axis, float from, float to, float bevel) {
  const Polygon full = CounterClockwise(outline);
  std::vector<Ring> rings;
  const auto add = [&](const Polygon& polygon, float along) {
    Ring& ring = rings.emplace_back();
    for (const Eigen::Vector2f& point : polygon) ring.push_back(InSpace(point, axis, along));
  };
  if (bevel > 0) {
    const Polygon inner = Inset(full, bevel);
    add(inner, from);
    add(full, from + std::copysign(bevel, to - from));
    add(full, to - std::copysign(bevel, to - from));
    add(inner, to);
  } else {
    add(full, from);
    add(full, to);
  }
  return Loft(rings);
}

Mesh Box(const Vec3& centre, const Vec3& size, float bevel) {
  const Vec3 half = size / 2;
  const float cut = std::min(bevel, 0.4F * half.minCoeff());
  const Polygon outline = Rounded(Rectangle(-half.z(), -half.x(), half.z(), half.x()), cut, 1);
  return Moved(Extrude(outline, Axis::kY, -half.y(), half.y(), cut), Eigen::Affine3f(Eigen::Translation3f(centre)));
}

Mesh Revolve(const Polygon& profile, Axis axis, int segments) {
  const Vec3 direction = Unit(axis);
  std::vector<Ring> rings;
  for (const Eigen::Vector2f& point : profile) {
    rings.push_back(Circle(direction * point.x(), direction, std::max(point.y(), 1e-4F), segments));
  }
  return Loft(rings);
}

Mesh Cylinder(const Vec3& from, const Vec3& to, float radius, int segments) {
  const Vec3 direction = (to - from).normalized();
  return Loft({Circle(from, direction, radius, segments), Circle(to, direction, radius, segments)});
}

Mesh Tube(const std::vector<Vec3>& path, float radius, int segments) {
  Mesh mesh;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    // Each segment overlaps the next, which closes the elbow.
    const Vec3 overlap = (path[i + 1] - path[i]).normalized() * (radius * 0.6F);
    mesh.Add(Cylinder(path[i] - overlap, path[i + 1] + overlap, radius, segments));
  }
  return mesh;
}

Mesh Ball(const Vec3& centre, const Vec3& radii, int segments) {
  const int rows = std::max(4, segments / 2);
  Polygon profile;
  for (int i = 0; i <= rows; ++i) {
    const float angle = kPi * static_cast<float>(i) / static_cast<float>(rows);
    profile.emplace_back(-std::cos(angle), std::sin(angle));
  }
  Mesh ball = Revolve(profile, Axis::kY, segments);
  return Bent(std::move(ball), [&](const Vec3& p) { return Vec3(centre + p.cwiseProduct(radii)); });
}

Mesh Wing(const std::vector<WingSection>& sections, const Vec3& up) {
  // Fractions of the chord and of half the thickness, from the leading edge over the top and back below.
  constexpr std::array<std::array<float, 2>, 10> kFoil = {{{0.0F, 0.0F},
                                                           {0.04F, 0.55F},
                                                           {0.2F, 0.95F},
                                                           {0.45F, 1.0F},
                                                           {0.75F, 0.55F},
                                                           {1.0F, 0.08F},
                                                           {1.0F, -0.08F},
                                                           {0.7F, -0.6F},
                                                           {0.3F, -1.0F},
                                                           {0.04F, -0.55F}}};
  std::vector<Ring> rings;
  for (const WingSection& section : sections) {
    Ring& ring = rings.emplace_back();
    for (const auto& [back, height] : kFoil) {
      ring.push_back(section.leading_edge - Vec3::UnitZ() * (back * section.chord) +
                     up * (height * section.thickness / 2));
    }
  }
  return Loft(rings);
}

std::vector<Vec3> CornerNormals(const Mesh& mesh, float crease_deg) {
  using Key = std::tuple<std::int64_t, std::int64_t, std::int64_t>;
  const auto key = [](const Vec3& p) {
    return Key{std::llround(p.x() * 5e3F), std::llround(p.y() * 5e3F), std::llround(p.z() * 5e3F)};
  };
  std::vector<Vec3> areas;
  std::map<Key, std::vector<int>> faces_at;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    areas.push_back((mesh.points[b] - mesh.points[a]).cross(mesh.points[c] - mesh.points[a]));
    for (const int corner : mesh.triangles[t]) faces_at[key(mesh.points[corner])].push_back(static_cast<int>(t));
  }
  const float least = std::cos(Radians(crease_deg));
  std::vector<Vec3> normals;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3 own = areas[t].normalized();
    for (const int corner : mesh.triangles[t]) {
      Vec3 sum = Vec3::Zero();
      for (const int other : faces_at[key(mesh.points[corner])]) {
        if (areas[other].normalized().dot(own) >= least) sum += areas[other];
      }
      normals.push_back(sum.norm() > 1e-12F ? Vec3(sum.normalized()) : own);
    }
  }
  return normals;
}

}  // namespace victorious::assets

#include "victorious/geometry/polygon.h"

#include <algorithm>
#include <cmath>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

// Twice the signed area of the triangle a b c.
double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
}

}  // namespace

double SignedArea(const Polygon& polygon) {
  // A triangle fan from the first corner: no cancellation for polygons far from the origin.
  double twice = 0;
  for (std::size_t i = 2; i < polygon.size(); ++i) twice += Cross(polygon[0], polygon[i - 1], polygon[i]);
  return twice / 2;
}

Box BoundingBox(const Polygon& polygon) {
  if (polygon.empty()) return {};
  Eigen::Vector2d low = polygon.front();
  Eigen::Vector2d high = polygon.front();
  for (const Eigen::Vector2d& corner : polygon) {
    low = low.cwiseMin(corner);
    high = high.cwiseMax(corner);
  }
  return {low.x(), low.y(), high.x() - low.x(), high.y() - low.y()};
}

Polygon BoxCorners(const Box& box) {
  return {
      {box.x, box.y}, {box.x + box.width, box.y}, {box.x + box.width, box.y + box.height}, {box.x, box.y + box.height}};
}

Polygon ClipToConvex(const Polygon& subject, const Polygon& clip) {
  const double clip_area = SignedArea(clip);
  if (clip_area == 0) return {};
  const double sense = clip_area < 0 ? -1.0 : 1.0;
  Polygon result = subject;
  for (std::size_t edge = 0; edge < clip.size() && !result.empty(); ++edge) {
    const Eigen::Vector2d& a = clip[edge];
    const Eigen::Vector2d& b = clip[(edge + 1) % clip.size()];
    const auto inside_distance = [&](const Eigen::Vector2d& p) { return sense * Cross(a, b, p); };
    Polygon kept;
    for (std::size_t i = 0; i < result.size(); ++i) {
      const Eigen::Vector2d& from = result[i];
      const Eigen::Vector2d& to = result[(i + 1) % result.size()];
      const double d_from = inside_distance(from);
      const double d_to = inside_distance(to);
      if (d_from >= 0) kept.push_back(from);
      if ((d_from >= 0) != (d_to >= 0)) kept.push_back(from + (to - from) * (d_from / (d_from - d_to)));
    }
    result = std::move(kept);
  }
  return result;
}

Polygon ClipToBox(const Polygon& subject, const Box& box) { return ClipToConvex(subject, BoxCorners(box)); }

double FractionInside(const Polygon& subject, const Box& box) {
  const double area = std::abs(SignedArea(subject));
  return area > 0 ? std::abs(SignedArea(ClipToBox(subject, box))) / area : 0.0;
}

bool IsConvex(const Polygon& polygon) {
  const std::size_t n = polygon.size();
  if (n < 3) return false;
  double turned = 0;
  int sense = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector2d in = polygon[(i + 1) % n] - polygon[i];
    const Eigen::Vector2d out = polygon[(i + 2) % n] - polygon[(i + 1) % n];
    const double turn = std::atan2(in.x() * out.y() - in.y() * out.x(), in.dot(out));
    if (!(std::abs(turn) < kPi)) return false;  // reverses direction, or is not finite
    if (turn == 0) continue;
    const int turn_sense = turn > 0 ? 1 : -1;
    if (sense != 0 && turn_sense != sense) return false;
    sense = turn_sense;
    turned += turn;
  }
  return sense != 0 && std::abs(std::abs(turned) - 2 * kPi) < 1e-6;
}

Polygon ConvexHull(std::vector<Eigen::Vector2d> points) {
  std::ranges::sort(points,
                    [](const auto& a, const auto& b) { return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y(); });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  Polygon hull(2 * points.size());
  std::size_t size = 0;
  const auto extend = [&](const Eigen::Vector2d& point, std::size_t floor) {
    while (size >= floor + 2 && Cross(hull[size - 2], hull[size - 1], point) <= 0) --size;
    hull[size++] = point;
  };
  for (const auto& point : points) extend(point, 0);
  const std::size_t upper = size - 1;
  for (std::size_t i = points.size() - 1; i-- > 0;) extend(points[i], upper);
  hull.resize(size - 1);
  return hull;
}

double IntersectionOverUnion(const Polygon& a, const Polygon& b) {
  const double common = std::abs(SignedArea(ClipToConvex(a, b)));
  const double joined = std::abs(SignedArea(a)) + std::abs(SignedArea(b)) - common;
  return joined > 0 ? common / joined : 0.0;
}

}  // namespace victorious

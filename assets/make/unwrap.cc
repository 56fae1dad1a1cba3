#include "assets/make/unwrap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <numeric>
#include <optional>

#include "victorious/base/check.h"

namespace victorious::assets {
namespace {

constexpr float kBottomScale = 0.3F;  // texture scale of the rarely visible underside, relative to the rest

Side Facing(const Vec3& normal, bool share_sides) {
  const Vec3 size = normal.cwiseAbs();
  // Sloping roofs and bonnets use the top chart: the camera looks from above.
  if (size.y() * 1.15F >= std::max(size.x(), size.z())) return normal.y() > 0 ? Side::kTop : Side::kBottom;
  if (size.x() >= size.z()) return normal.x() > 0 || share_sides ? Side::kLeft : Side::kRight;
  return normal.z() > 0 || share_sides ? Side::kFront : Side::kBack;
}

/// Shelf packing, tallest chart first; false if the charts do not fit.
bool Pack(std::vector<Chart>& charts, const std::vector<std::size_t>& order, int atlas_px) {
  int x = 0;
  int y = 0;
  int shelf = 0;
  for (const std::size_t i : order) {
    cv::Rect& place = charts[i].place;
    if (place.width > atlas_px) return false;
    if (x + place.width > atlas_px) {
      y += shelf;
      x = 0;
      shelf = 0;
    }
    place.x = x;
    place.y = y;
    x += place.width;
    shelf = std::max(shelf, place.height);
    if (y + shelf > atlas_px) return false;
  }
  return true;
}

bool PackAt(std::vector<Chart>& charts, const std::vector<Part>& parts, float texels_per_m, int atlas_px) {
  for (Chart& chart : charts) {
    chart.texels_per_m = texels_per_m * parts[chart.part].density * (chart.side == Side::kBottom ? kBottomScale : 1.0F);
    const cv::Point2f extent = (chart.max_corner - chart.min_corner) * chart.texels_per_m;
    chart.place.width = static_cast<int>(std::ceil(extent.x)) + 2 * kChartMargin_px;
    chart.place.height = static_cast<int>(std::ceil(extent.y)) + 2 * kChartMargin_px;
  }
  std::vector<std::size_t> order(charts.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(
      order, [&](std::size_t a, std::size_t b) { return charts[a].place.height > charts[b].place.height; });
  return Pack(charts, order, atlas_px);
}

}  // namespace

cv::Point2f ProjectToChart(const Vec3& p, Side side) {
  switch (side) {
    case Side::kLeft:
      return {-p.z(), -p.y()};
    case Side::kRight:
      return {p.z(), -p.y()};
    case Side::kTop:
      return {p.z(), -p.x()};
    case Side::kBottom:
      return {p.z(), p.x()};
    case Side::kFront:
      return {p.x(), -p.y()};
    case Side::kBack:
      break;
  }
  return {-p.x(), -p.y()};
}

Vec3 Outward(Side side) {
  constexpr std::array<std::array<float, 3>, 6> kOutward = {
      {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}};
  return Vec3(kOutward[static_cast<std::size_t>(side)].data());
}

cv::Point2f ProjectToAtlas(const Vec3& point, const Chart& chart) {
  const cv::Point2f from_corner = (ProjectToChart(point, chart.side) - chart.min_corner) * chart.texels_per_m;
  return from_corner + cv::Point2f(static_cast<float>(chart.place.x + kChartMargin_px),
                                   static_cast<float>(chart.place.y + kChartMargin_px));
}

Unwrap UnwrapParts(const std::vector<Part>& parts, int atlas_px) {
  Unwrap unwrap;
  for (std::size_t part = 0; part < parts.size(); ++part) {
    const Mesh& mesh = parts[part].mesh;
    std::map<Side, int> chart_at;
    std::vector<int>& triangle_charts = unwrap.triangle_charts.emplace_back();
    for (const auto& [a, b, c] : mesh.triangles) {
      const Vec3 normal = (mesh.points[b] - mesh.points[a]).cross(mesh.points[c] - mesh.points[a]).normalized();
      const Side side = Facing(normal, parts[part].share_sides);
      const auto [found, added] = chart_at.try_emplace(side, static_cast<int>(unwrap.charts.size()));
      if (added) unwrap.charts.push_back({static_cast<int>(part), side, {1e9F, 1e9F}, {-1e9F, -1e9F}});
      triangle_charts.push_back(found->second);
      Chart& chart = unwrap.charts[found->second];
      for (const int corner : {a, b, c}) {
        const cv::Point2f at = ProjectToChart(mesh.points[corner], side);
        chart.min_corner = {std::min(chart.min_corner.x, at.x), std::min(chart.min_corner.y, at.y)};
        chart.max_corner = {std::max(chart.max_corner.x, at.x), std::max(chart.max_corner.y, at.y)};
      }
    }
  }
  float fits = 1;
  float too_much = 4096;
  while (too_much / fits > 1.003F) {
    const float middle = std::sqrt(fits * too_much);
    (PackAt(unwrap.charts, parts, middle, atlas_px) ? fits : too_much) = middle;
  }
  VICTORIOUS_CHECK(PackAt(unwrap.charts, parts, fits, atlas_px));
  return unwrap;
}

}  // namespace victorious::assets

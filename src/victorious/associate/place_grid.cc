#include "victorious/associate/place_grid.h"

#include <algorithm>
#include <cmath>

namespace victorious {
namespace {

// Cells are wider than the reach by more than coordinates are rounded: 1e-6 m at the radius of the Earth.
constexpr double kMargin_m = 1e-3;

}  // namespace

PlaceGrid::PlaceGrid(double reach_m) : cell_m_(reach_m + kMargin_m) {}

void PlaceGrid::Add(const GeodeticPoint& point, std::int64_t item) { items_[CellOf(point)].push_back(item); }

void PlaceGrid::Remove(const GeodeticPoint& point, std::int64_t item) {
  const auto cell = items_.find(CellOf(point));
  if (cell == items_.end()) return;
  std::erase(cell->second, item);
  if (cell->second.empty()) items_.erase(cell);
}

std::vector<std::int64_t> PlaceGrid::Near(const GeodeticPoint& point) const {
  const Cell centre = CellOf(point);
  std::vector<std::int64_t> near;
  for (std::int64_t x = centre[0] - 1; x <= centre[0] + 1; ++x) {
    for (std::int64_t y = centre[1] - 1; y <= centre[1] + 1; ++y) {
      for (std::int64_t z = centre[2] - 1; z <= centre[2] + 1; ++z) {
        const auto cell = items_.find({x, y, z});
        if (cell != items_.end()) near.insert(near.end(), cell->second.begin(), cell->second.end());
      }
    }
  }
  std::ranges::sort(near);
  return near;
}

PlaceGrid::Cell PlaceGrid::CellOf(const GeodeticPoint& point) const {
  const Eigen::Vector3d at = EarthCenteredFromGeodetic(point) / cell_m_;
  return {std::llround(std::floor(at.x())), std::llround(std::floor(at.y())), std::llround(std::floor(at.z()))};
}

}  // namespace victorious

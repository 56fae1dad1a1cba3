#include "victorious/place/associate/place_grid.h"

#include <algorithm>
#include <cmath>

namespace victorious {
namespace {

// More than coordinates are rounded: 1e-6 m at the radius of the Earth.
constexpr double kMargin_m = 1e-3;

}  // namespace

// The reach of a point touches at most two cells along each axis.
PlaceGrid::PlaceGrid(double reach_m) : reach_m_(reach_m + kMargin_m), cell_m_(2 * reach_m_) {}

void PlaceGrid::Add(const GeodeticPoint& point, std::int64_t item) {
  const Eigen::Vector3d at = EarthCenteredFromGeodetic(point);
  entries_[CellOf(at)].push_back({at, item});
}

void PlaceGrid::Remove(const GeodeticPoint& point, std::int64_t item) {
  const auto cell = entries_.find(CellOf(EarthCenteredFromGeodetic(point)));
  if (cell == entries_.end()) return;
  std::erase_if(cell->second, [&](const Entry& entry) { return entry.item == item; });
  if (cell->second.empty()) entries_.erase(cell);
}

std::vector<std::int64_t> PlaceGrid::Near(const GeodeticPoint& point) const {
  const Eigen::Vector3d at = EarthCenteredFromGeodetic(point);
  const Eigen::Vector3d reach = Eigen::Vector3d::Constant(reach_m_);
  const Cell low = CellOf(at - reach);
  const Cell high = CellOf(at + reach);
  std::vector<std::int64_t> near;
  for (std::int64_t x = low[0]; x <= high[0]; ++x) {
    for (std::int64_t y = low[1]; y <= high[1]; ++y) {
      for (std::int64_t z = low[2]; z <= high[2]; ++z) {
        const auto cell = entries_.find({x, y, z});
        if (cell == entries_.end()) continue;
        for (const Entry& entry : cell->second) {
          if ((entry.at - at).norm() <= reach_m_) near.push_back(entry.item);
        }
      }
    }
  }
  std::ranges::sort(near);
  return near;
}

std::size_t PlaceGrid::Hash::operator()(const Cell& cell) const {
  std::uint64_t hash = 0;
  for (const std::int64_t index : cell) hash = (hash ^ static_cast<std::uint64_t>(index)) * 0x9E3779B97F4A7C15;
  return static_cast<std::size_t>(hash ^ (hash >> 32));
}

PlaceGrid::Cell PlaceGrid::CellOf(const Eigen::Vector3d& at) const {
  const Eigen::Vector3d index = at / cell_m_;
  return {std::llround(std::floor(index.x())), std::llround(std::floor(index.y())),
          std::llround(std::floor(index.z()))};
}

}  // namespace victorious

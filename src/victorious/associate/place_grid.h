// Finds the places near a place, among many: a hash grid over Cartesian coordinates.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "victorious/geometry/geodesy.h"

namespace victorious {

class PlaceGrid {
 public:
  /// @param reach_m  at least 0
  explicit PlaceGrid(double reach_m);

  void Add(const GeodeticPoint& point, std::int64_t item);
  /// Removes an item that was added at this point.
  void Remove(const GeodeticPoint& point, std::int64_t item);

  /// The items within the reach of `point`, and some within four reaches of it. Ascending.
  [[nodiscard]] std::vector<std::int64_t> Near(const GeodeticPoint& point) const;

 private:
  using Cell = std::array<std::int64_t, 3>;

  [[nodiscard]] Cell CellOf(const GeodeticPoint& point) const;

  double cell_m_;
  std::map<Cell, std::vector<std::int64_t>> items_;
};

}  // namespace victorious

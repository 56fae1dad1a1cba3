// Finds the places near a place, among many: a hash grid over Cartesian coordinates.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

#include "victorious/geometry/geodesy.h"

namespace victorious {

class PlaceGrid {
 public:
  /// @param reach_m  at least 0
  explicit PlaceGrid(double reach_m);

  void Add(const GeodeticPoint& point, std::int64_t item);
  /// Removes an item that was added at this point.
  void Remove(const GeodeticPoint& point, std::int64_t item);

  /// The items within the reach of `point`, and at most a few millimetres beyond. Ascending.
  [[nodiscard]] std::vector<std::int64_t> Near(const GeodeticPoint& point) const;

 private:
  using Cell = std::array<std::int64_t, 3>;
  struct Hash {
    std::size_t operator()(const Cell& cell) const;
  };
  struct Entry {
    Eigen::Vector3d at;  // m
    std::int64_t item = 0;
  };

  [[nodiscard]] Cell CellOf(const Eigen::Vector3d& at) const;

  double reach_m_;
  double cell_m_;
  std::unordered_map<Cell, std::vector<Entry>, Hash> entries_;
};

}  // namespace victorious

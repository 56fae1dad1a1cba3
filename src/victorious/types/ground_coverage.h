// How well the ground of a flight was searched: a grid of cells between parallels and meridians, in rows from north to
// south. Made by show/coverage_job.h, written by show/export/export_coverage.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace victorious {

/// Of one model; a value for each cell of the grid.
struct ModelCoverage {
  std::string model;
  double diagonal_m = 0;           ///< of its bounding box
  std::vector<float> probability;  ///< that one that stands there would have been found
  std::vector<float> size_px;      ///< its largest diagonal in a frame; 0: it was in none
};

/// Fields of cells are empty, or have columns x rows values, by row.
struct GroundCoverage {
  double north_rad = 0;   ///< upper edge of the first row
  double west_rad = 0;    ///< left edge of the first column
  double row_rad = 0;     ///< height of a cell, > 0
  double column_rad = 0;  ///< width of a cell, > 0
  double cell_m = 0;      ///< side of a cell on the ground
  int columns = 0;
  int rows = 0;
  std::vector<std::uint8_t> in_area;  ///< 1: the cell belongs to the area that was to be searched
  std::vector<std::uint16_t> looks;   ///< frames, one each look interval, that show the middle of the cell
  std::vector<std::uint16_t> views;   ///< independent ones of them (place/geolocate/view_detection.h)
  std::vector<float> off_nadir_rad;   ///< of the nearest view; 0 without one
  std::vector<ModelCoverage> models = {};

  [[nodiscard]] std::size_t CellCount() const {
    return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  }
};

}  // namespace victorious

// A frame's lines of sight, in cells by azimuth: a wide camera's spread far, and each looks at its object from another
// side, and so under another sun.
#pragma once

#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "victorious/geometry/box.h"
#include "victorious/geometry/vertical.h"

namespace victorious {

class SightCells {
 public:
  /// @param vertical   nothing where nobody tells the camera's attitude: then there are no lines, and one cell
  /// @param part       of the frame, which is searched, px
  /// @param width_rad  of a cell, about: as many as the spread needs, mostly one
  SightCells(const std::optional<Vertical>& vertical, const Box& part, double width_rad);

  /// How far off nadir the lines are, least and most, rad; 0 and pi where there are none.
  [[nodiscard]] std::pair<double, double> OffNadir() const;

  /// The middle of the cell that an azimuth (Vertical::AzimuthAt) is in, or, beyond the part, of the one nearest to it.
  [[nodiscard]] double MiddleOf(double aside_rad) const;

  /// The middles of the cells with lines that can show a view of what stands upright.
  /// @param most_tilt_rad  by how much these may lie from the view's own
  [[nodiscard]] std::set<double> MiddlesOf(double view_off_nadir_rad, double most_tilt_rad) const;

 private:
  struct Line {
    double off_nadir_rad;
    double aside_rad;
  };

  std::vector<Line> lines_;
  double count_ = 1;
  double width_rad_ = 0;
  double first_rad_ = 0;  // middle of the first cell
};

}  // namespace victorious

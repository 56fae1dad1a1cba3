// recognize/, for VoteSearch: divides a frame's lines of sight into cells of azimuth. In a wide field of view the
// azimuth of the line of sight varies, and with it the sun's direction relative to the viewing direction, so each cell
// needs its own relit templates.
#pragma once

#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "victorious/geometry/box.h"
#include "victorious/geometry/vertical.h"

namespace victorious {

class AzimuthCells {
 public:
  /// @param vertical   in the camera frame; nullopt for an unknown attitude: one cell without lines of sight
  /// @param part       searched region of the frame, px; sampled on a 9 x 9 grid
  /// @param width_rad  approximate width of a cell; the region's azimuth range is divided evenly, mostly into one cell
  AzimuthCells(const std::optional<Vertical>& vertical, const Box& part, double width_rad);

  /// Minimum and maximum off-nadir angle of the lines of sight, rad; 0 and pi for an unknown attitude.
  [[nodiscard]] std::pair<double, double> OffNadirRange() const;

  /// The centre azimuth, rad, of the cell that contains `relative_azimuth_rad`, or of the nearest cell outside the
  /// region.
  /// @param relative_azimuth_rad  azimuth relative to the line of sight through the image centre (Vertical::AzimuthAt)
  [[nodiscard]] double CellCentre(double relative_azimuth_rad) const;

  /// The centre azimuths, rad, of the cells whose lines of sight can show a view of an upright object; empty for an
  /// unknown attitude.
  /// @param max_tilt_rad  bound on the difference between the off-nadir angles of line of sight and view
  [[nodiscard]] std::set<double> CellCentresForView(double view_off_nadir_rad, double max_tilt_rad) const;

 private:
  struct Line {
    double off_nadir_rad;
    double relative_azimuth_rad;
  };

  std::vector<Line> lines_;
  double count_ = 1;
  double width_rad_ = 0;
  double first_rad_ = 0;  // centre of the first cell
};

}  // namespace victorious

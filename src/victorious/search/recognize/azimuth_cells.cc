#include "victorious/search/recognize/azimuth_cells.h"

#include <algorithm>
#include <cmath>

#include "victorious/geometry/angles.h"

namespace victorious {

AzimuthCells::AzimuthCells(const std::optional<Vertical>& vertical, const Box& part, double width_rad) {
  if (!vertical) return;
  constexpr int kSteps = 8;  // grid intervals over the region's width and height
  for (int row = 0; row <= kSteps; ++row) {
    for (int column = 0; column <= kSteps; ++column) {
      const Eigen::Vector2d pixel(part.x + part.width * column / kSteps, part.y + part.height * row / kSteps);
      lines_.push_back(
          {std::acos(std::clamp(-vertical->UpVectorAt(pixel).z(), -1.0, 1.0)), vertical->AzimuthAt(pixel)});
    }
  }
  const auto [first, last] = std::ranges::minmax_element(lines_, {}, &Line::relative_azimuth_rad);
  const bool contains_nadir =
      last->relative_azimuth_rad - first->relative_azimuth_rad > 1.5 * kPi;  // the region contains the nadir
  const double from_rad = contains_nadir ? -kPi : first->relative_azimuth_rad;
  const double spread_rad = contains_nadir ? 2 * kPi : last->relative_azimuth_rad - first->relative_azimuth_rad;
  count_ = std::max(1.0, std::round(spread_rad / width_rad));
  width_rad_ = spread_rad / count_;
  first_rad_ = from_rad + width_rad_ / 2;
}

std::pair<double, double> AzimuthCells::OffNadirRange() const {
  if (lines_.empty()) return {0, kPi};
  const auto [first, last] = std::ranges::minmax_element(lines_, {}, &Line::off_nadir_rad);
  return {first->off_nadir_rad, last->off_nadir_rad};
}

double AzimuthCells::CellCentre(double relative_azimuth_rad) const {
  if (!(width_rad_ > 0)) return first_rad_;
  return first_rad_ +
         width_rad_ * std::clamp(std::round((relative_azimuth_rad - first_rad_) / width_rad_), 0.0, count_ - 1);
}

std::set<double> AzimuthCells::CellCentresForView(double view_off_nadir_rad, double max_tilt_rad) const {
  std::set<double> middles;
  for (const Line& line : lines_) {
    if (std::abs(line.off_nadir_rad - view_off_nadir_rad) <= max_tilt_rad)
      middles.insert(CellCentre(line.relative_azimuth_rad));
  }
  return middles;
}

}  // namespace victorious

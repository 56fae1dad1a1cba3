#include "victorious/recognize/azimuth_cells.h"

#include <algorithm>
#include <cmath>

#include "victorious/geometry/angles.h"

namespace victorious {

SightCells::SightCells(const std::optional<Vertical>& vertical, const Box& part, double width_rad) {
  if (!vertical) return;
  constexpr int kSteps = 8;  // grid intervals over the region's width and height
  for (int row = 0; row <= kSteps; ++row) {
    for (int column = 0; column <= kSteps; ++column) {
      const Eigen::Vector2d pixel(part.x + part.width * column / kSteps, part.y + part.height * row / kSteps);
      lines_.push_back({std::acos(std::clamp(-vertical->SeenAt(pixel).z(), -1.0, 1.0)), vertical->AzimuthAt(pixel)});
    }
  }
  const auto [least, most] = std::ranges::minmax_element(lines_, {}, &Line::aside_rad);
  const bool all_around = most->aside_rad - least->aside_rad > 1.5 * kPi;  // the region contains the nadir
  const double from_rad = all_around ? -kPi : least->aside_rad;
  const double spread_rad = all_around ? 2 * kPi : most->aside_rad - least->aside_rad;
  count_ = std::max(1.0, std::round(spread_rad / width_rad));
  width_rad_ = spread_rad / count_;
  first_rad_ = from_rad + width_rad_ / 2;
}

std::pair<double, double> SightCells::OffNadir() const {
  if (lines_.empty()) return {0, kPi};
  const auto [least, most] = std::ranges::minmax_element(lines_, {}, &Line::off_nadir_rad);
  return {least->off_nadir_rad, most->off_nadir_rad};
}

double SightCells::MiddleOf(double aside_rad) const {
  if (!(width_rad_ > 0)) return first_rad_;
  return first_rad_ + width_rad_ * std::clamp(std::round((aside_rad - first_rad_) / width_rad_), 0.0, count_ - 1);
}

std::set<double> SightCells::MiddlesOf(double view_off_nadir_rad, double most_tilt_rad) const {
  std::set<double> middles;
  for (const Line& line : lines_) {
    if (std::abs(line.off_nadir_rad - view_off_nadir_rad) <= most_tilt_rad) middles.insert(MiddleOf(line.aside_rad));
  }
  return middles;
}

}  // namespace victorious

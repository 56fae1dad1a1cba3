// What is known of a camera's attitude says of a pose before any match: objects stand upright, so of the ways in which
// a view can be turned in a scene only those are left at which the object's own up is seen where it can be: near the
// vertical (geometry/vertical.h) where the attitude is told; else not downwards in the picture, since nobody films
// upside down.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "victorious/geometry/angles.h"
#include "victorious/geometry/vertical.h"

namespace victorious {

/// For one view. Made for each; cheap.
class UprightPrior {
 public:
  /// @param off_nadir_rad  of the view
  /// @param most_tilt_rad  between the object's up and the vertical: its own tilt and the step between views
  static UprightPrior Told(const Vertical& vertical, double off_nadir_rad, double most_tilt_rad) {
    return {vertical, off_nadir_rad, std::cos(most_tilt_rad), 0.5 * (1 - std::cos(most_tilt_rad))};
  }

  /// @param off_nadir_rad     of the view
  /// @param most_hanging_rad  how far below the picture's horizontal the object's up may point, [0, pi/2]; views
  ///                          nearer to the nadir than this can be turned in any way
  static UprightPrior Supposed(double off_nadir_rad, double most_hanging_rad) {
    const double lowest = -std::sin(most_hanging_rad);
    const double steepness = std::max(std::sin(off_nadir_rad), -lowest);
    return {std::nullopt, off_nadir_rad, lowest, steepness > 0 ? std::acos(lowest / steepness) / kPi : 1.0};
  }

  /// @param centre_px  of the object, in the scene
  /// @param turn_rad   from the view to the scene, clockwise
  [[nodiscard]] bool Allows(const Eigen::Vector2d& centre_px, double turn_rad) const {
    const Eigen::Vector3d up = UpOfView(off_nadir_rad_, turn_rad);
    return (vertical_ ? up.dot(vertical_->SeenAt(centre_px)) : -up.y()) >= least_;
  }

  /// Decades by which it lessens the number of views and turns that a pose is chosen from.
  [[nodiscard]] double Decades() const { return -std::log10(share_); }

 private:
  UprightPrior(const std::optional<Vertical>& vertical, double off_nadir_rad, double least, double share)
      : vertical_(vertical), off_nadir_rad_(off_nadir_rad), least_(least), share_(share) {}

  std::optional<Vertical> vertical_;
  double off_nadir_rad_;
  double least_;  // of the object's up, along the vertical or upwards in the picture
  double share_;  // of all views and turns that are allowed
};

}  // namespace victorious

// What the camera's attitude says of a pose before any match: objects stand upright, so of the ways in which a view can
// be turned in a scene only those are left at which the object's own up lies near the vertical (geometry/vertical.h).
#pragma once

#include <cmath>

#include "victorious/geometry/vertical.h"

namespace victorious {

/// For one view. Made for each; cheap.
class UprightPrior {
 public:
  /// @param off_nadir_rad  of the view
  /// @param most_tilt_rad  between the object's up and the vertical: its own tilt and the step between views
  UprightPrior(const Vertical& vertical, double off_nadir_rad, double most_tilt_rad)
      : vertical_(vertical), off_nadir_rad_(off_nadir_rad), least_cosine_(std::cos(most_tilt_rad)) {}

  /// @param centre_px  of the object, in the scene
  /// @param turn_rad   from the view to the scene, clockwise
  [[nodiscard]] bool Allows(const Eigen::Vector2d& centre_px, double turn_rad) const {
    return UpOfView(off_nadir_rad_, turn_rad).dot(vertical_.SeenAt(centre_px)) >= least_cosine_;
  }

  /// Decades by which it lessens the number of views and turns that a pose is chosen from.
  [[nodiscard]] double Decades() const { return -std::log10(0.5 * (1 - least_cosine_)); }

 private:
  Vertical vertical_;
  double off_nadir_rad_;
  double least_cosine_;
};

}  // namespace victorious

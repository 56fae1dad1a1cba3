// pose/, prior of VotePoses from the camera's attitude. Objects stand upright, which limits the in-plane rotation of a
// view in the scene: with a known attitude the object's up axis lies near the vertical (geometry/vertical.h); with an
// unknown attitude the camera is assumed not to be upside down, so the up axis does not point downwards in the image.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "victorious/geometry/angles.h"
#include "victorious/geometry/vertical.h"

namespace victorious {

/// The prior of one view. Cheap to construct.
class UprightPrior {
 public:
  /// Known attitude.
  /// @param vertical       in the camera frame
  /// @param off_nadir_rad  off-nadir angle of the view
  /// @param max_tilt_rad   bound on the angle between the object's up axis and the vertical: tilt of the object plus
  ///                       the angular step between views
  static UprightPrior FromVertical(const Vertical& vertical, double off_nadir_rad, double max_tilt_rad) {
    return {vertical, off_nadir_rad, std::cos(max_tilt_rad), 0.5 * (1 - std::cos(max_tilt_rad))};
  }

  /// Unknown attitude: the camera is assumed to be held upright.
  /// @param off_nadir_rad    off-nadir angle of the view
  /// @param max_hanging_rad  bound on the angle of the object's up axis below the image's horizontal, [0, pi/2]; views
  ///                         nearer to the nadir than this may have any rotation
  static UprightPrior AssumingUprightCamera(double off_nadir_rad, double max_hanging_rad) {
    const double lowest = -std::sin(max_hanging_rad);
    const double steepness = std::max(std::sin(off_nadir_rad), -lowest);
    return {std::nullopt, off_nadir_rad, lowest, steepness > 0 ? std::acos(lowest / steepness) / kPi : 1.0};
  }

  /// @param centre_px  object centre in the scene
  /// @param turn_rad   in-plane rotation from view to scene, clockwise
  [[nodiscard]] bool IsAllowed(const Eigen::Vector2d& centre_px, double turn_rad) const {
    const Eigen::Vector3d up = ViewUpVector(off_nadir_rad_, turn_rad);
    return (vertical_ ? up.dot(vertical_->UpVectorAt(centre_px)) : -up.y()) >= min_component_;
  }

  /// log10 of the factor by which the prior reduces the number of tested poses (views x rotations); >= 0.
  [[nodiscard]] double SearchReductionDecades() const { return -std::log10(allowed_fraction_); }

 private:
  UprightPrior(const std::optional<Vertical>& vertical, double off_nadir_rad, double min_component,
               double allowed_fraction)
      : vertical_(vertical),
        off_nadir_rad_(off_nadir_rad),
        min_component_(min_component),
        allowed_fraction_(allowed_fraction) {}

  std::optional<Vertical> vertical_;
  double off_nadir_rad_;
  double min_component_;     // minimum component of the object's up axis along the vertical, or upwards in the image
  double allowed_fraction_;  // fraction of views x rotations that is allowed
};

}  // namespace victorious

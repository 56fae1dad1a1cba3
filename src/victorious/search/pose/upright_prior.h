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
    const double across = up_in_view_.y();
    const Eigen::Vector3d up(-across * std::sin(turn_rad), across * std::cos(turn_rad), up_in_view_.z());
    return (vertical_ ? up.dot(vertical_->UpVectorAt(centre_px)) : -up.y()) >= min_component_;
  }

  /// The largest difference, rad, between an allowed rotation and the lean of the vertical (Vertical::LeanAt; 0 for an
  /// unknown attitude), over lines of sight of these off-nadir angles; pi if every rotation is allowed somewhere.
  /// The up axes within the tilt of the view's axis form a cone about off_nadir. Its half width seen along a line of
  /// sight has one maximum, asin(sin(tilt) / sin(off_nadir)), unless the cone contains the vertical.
  [[nodiscard]] double MaxTurnFromLean(double min_ray_rad, double max_ray_rad) const {
    const double steepness = std::sin(off_nadir_rad_);
    if (!vertical_) return -min_component_ >= steepness ? kPi : std::acos(min_component_ / steepness);
    const auto half_width = [&](double ray_rad) {
      const double along = std::cos(off_nadir_rad_) * std::cos(ray_rad);
      const double across = steepness * std::sin(ray_rad);
      if (min_component_ - along > across) return 0.0;
      return min_component_ - along <= -across ? kPi : std::acos((min_component_ - along) / across);
    };
    const double widest = std::max(half_width(min_ray_rad), half_width(max_ray_rad));
    const double cosine = std::cos(off_nadir_rad_) / min_component_;  // of the line of sight of the maximum
    if (min_component_ <= 0 || std::abs(cosine) >= 1) return min_component_ <= 0 ? kPi : widest;
    const double at_maximum_rad = std::acos(cosine);
    if (at_maximum_rad < min_ray_rad || at_maximum_rad > max_ray_rad) return widest;
    return std::max(widest, half_width(at_maximum_rad));
  }

  /// log10 of the factor by which the prior reduces the number of tested poses (views x rotations); >= 0.
  [[nodiscard]] double SearchReductionDecades() const { return -std::log10(allowed_fraction_); }

 private:
  UprightPrior(const std::optional<Vertical>& vertical, double off_nadir_rad, double min_component,
               double allowed_fraction)
      : vertical_(vertical),
        off_nadir_rad_(off_nadir_rad),
        up_in_view_(ViewUpVector(off_nadir_rad, 0)),
        min_component_(min_component),
        allowed_fraction_(allowed_fraction) {}

  std::optional<Vertical> vertical_;
  double off_nadir_rad_;
  Eigen::Vector3d up_in_view_;  // the object's up axis, in the y-z plane of the view's camera
  double min_component_;        // minimum component of the object's up axis along the vertical, or upwards in the image
  double allowed_fraction_;     // fraction of views x rotations that is allowed
};

}  // namespace victorious

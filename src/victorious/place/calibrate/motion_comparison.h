// Private to calibrate/: the motion of the image between frames beside that which telemetry predicts.
//
// Both are of flat ground of unknown height, as three components in px: right, down, and a rotation at points halfway
// to the image corners.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "victorious/geometry/geodesy.h"
#include "victorious/input/telemetry/camera_track.h"
#include "victorious/place/calibrate/time_offset.h"

namespace victorious {

/// Fewer pairs of frames tell nothing.
inline constexpr std::size_t kMinPairs = 20;

/// A camera pose in one east-north-up tangent plane.
struct PlanePose {
  Eigen::Vector3d place;
  Eigen::Quaterniond camera_from_plane;
  double focal_px = 0;
};

/// The pose at a time; std::nullopt where telemetry lacks the attitude or the field of view.
/// @param image_width  px, of the video's frames
[[nodiscard]] std::optional<PlanePose> PoseAt(const CameraTrajectory& cameras, double time_s, const TangentPlane& plane,
                                              int image_width);

class MotionComparison {
 public:
  /// Both must outlive it; there is at least one state.
  MotionComparison(const ImageMotions& seen, const CameraTrajectory& cameras);

  [[nodiscard]] std::size_t size() const { return measured_.size(); }
  [[nodiscard]] const Eigen::Vector3d& measured(std::size_t i) const { return measured_[i]; }
  [[nodiscard]] double time_s(std::size_t i) const { return seen_.motions[i].from_s; }

  /// Mean of the measured motion, shifted by `apart_s / 2` earlier and later; std::nullopt if frames are missing there.
  [[nodiscard]] std::optional<Eigen::Vector3d> MeanMeasured(std::size_t i, double apart_s) const;

  /// Camera poses at both times of every pair, for a time offset; std::nullopt where telemetry has none.
  using Poses = std::vector<std::optional<std::pair<PlanePose, PlanePose>>>;
  [[nodiscard]] Poses PosesAt(double offset_s) const;

  /// The altitude of ground at a depth of 1 / `per_m` below the median camera height, above or below a place.
  [[nodiscard]] double GroundAltitude(const Eigen::Vector3d& place, double per_m) const;

  /// Predicted motion of flat ground at a depth of 1 / `per_m` below the median camera height while the motions were
  /// measured; 0: at infinity.
  [[nodiscard]] std::optional<Eigen::Vector3d> Predict(const std::pair<PlanePose, PlanePose>& pair, double per_m) const;

 private:
  /// Accumulated motion up to a time within a pair, or at its ends.
  [[nodiscard]] std::optional<Eigen::Vector3d> SumAt(double time_s) const;

  const ImageMotions& seen_;
  const CameraTrajectory& cameras_;
  TangentPlane plane_;
  std::array<Eigen::Vector2d, 4> corners_;
  double height_m_ = 0;
  std::vector<Eigen::Vector3d> measured_;
  std::vector<Eigen::Vector3d> sums_;  // prefix sums of measured_, inclusive
};

/// Measured less predicted motion, for the pairs that telemetry covers.
struct ResidualSet {
  std::vector<std::size_t> pairs;
  std::vector<Eigen::Vector3d> residuals;
};

[[nodiscard]] ResidualSet ComputeResiduals(const MotionComparison& comparison, const MotionComparison::Poses& poses,
                                           double per_m);

/// Motions and their residuals, averaged over each second with five pairs of frames or more: what noise of telemetry
/// adds to one pair, it takes from the next.
struct SecondMotions {
  std::vector<Eigen::Vector3d> seen;
  std::vector<Eigen::Vector3d> residuals;
};

[[nodiscard]] SecondMotions AverageSeconds(const MotionComparison& comparison, const ResidualSet& residual_set);

/// The height of the ground that fits best, and what remains there.
struct BestHeight {
  double per_m = 0;
  double cost = 0;
  SecondMotions seconds;
};

/// Searches the heights from 1 m to 6400 m below the median camera height, to 2 %. std::nullopt with fewer than four
/// seconds.
/// @param cost  to be minimised
[[nodiscard]] std::optional<BestHeight> FindBestHeight(const MotionComparison& comparison,
                                                       const MotionComparison::Poses& poses,
                                                       const std::function<double(const SecondMotions&)>& cost);

/// The median of each component.
[[nodiscard]] Eigen::Vector3d Medians(const std::vector<Eigen::Vector3d>& values);

}  // namespace victorious

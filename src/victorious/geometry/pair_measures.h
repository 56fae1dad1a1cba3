// The geometric grammar's four measures of a pair of keypoints (thesis, section 3.2.4). All are relative: the same
// under shift, turn and scaling of the image; together with the two places they fix both keypoints' scales and
// orientations.
#pragma once

#include <algorithm>
#include <cmath>

#include "victorious/geometry/angles.h"

namespace victorious {

/// Of the pair (i, j), d being the length and direction of the line from i to j.
struct PairMeasures {
  double scale_ratio = 1;                   ///< s_i / s_j
  double mean_scale_to_distance = 0;        ///< (s_i + s_j) / (2 |d|); infinite where the two lie at one place
  double orientation_difference_rad = 0;    ///< theta_a = o_j - o_i, wrapped
  double mean_orientation_to_line_rad = 0;  ///< theta_b = line's direction - mean orientation, wrapped
};

/// The mean of two orientations is the middle of the short way from o_i to o_j. For opposite orientations both ways are
/// equally short and the mean is one of two: compare such measures by MeanOrientationDistortion, which is not upset.
/// @tparam PointLike  has x, y, scale_px, orientation_rad (types/feature_set.h: Keypoint)
template <typename PointLike>
PairMeasures MeasurePair(const PointLike& i, const PointLike& j) {
  const double dx = static_cast<double>(j.x) - i.x;
  const double dy = static_cast<double>(j.y) - i.y;
  PairMeasures measures;
  measures.scale_ratio = static_cast<double>(i.scale_px) / j.scale_px;
  measures.mean_scale_to_distance = (static_cast<double>(i.scale_px) + j.scale_px) / (2 * std::hypot(dx, dy));
  measures.orientation_difference_rad = WrapAngle(static_cast<double>(j.orientation_rad) - i.orientation_rad);
  const double mean_orientation = i.orientation_rad + measures.orientation_difference_rad / 2;
  measures.mean_orientation_to_line_rad = WrapAngle(std::atan2(dy, dx) - mean_orientation);
  return measures;
}

/// The thesis's distortion factor of a ratio (section 3.3.3): max(a/b, b/a) >= 1.
inline double RatioDistortion(double a, double b) { return std::max(a / b, b / a); }

/// The distortion of theta_a: the wrapped absolute difference. Ratios of angles mean nothing near 0.
inline double OrientationDistortion(const PairMeasures& a, const PairMeasures& b) {
  return std::abs(WrapAngle(a.orientation_difference_rad - b.orientation_difference_rad));
}

/// The distortion of theta_b. Where orientations are nearly opposite in both pairs, noise may send the two short ways
/// round opposite sides, and the two means apart by pi: then the half turn is taken back.
inline double MeanOrientationDistortion(const PairMeasures& a, const PairMeasures& b) {
  const bool opposite_sides =
      std::abs(a.orientation_difference_rad - b.orientation_difference_rad) > kPi;  // the short way between them wraps
  const double half_turn = opposite_sides ? kPi : 0.0;
  return std::abs(WrapAngle(a.mean_orientation_to_line_rad - b.mean_orientation_to_line_rad + half_turn));
}

}  // namespace victorious

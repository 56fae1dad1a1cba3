// The four pair measures of the geometric grammar (thesis, section 3.2.4). All are invariant under translation,
// rotation and scaling of the image; together with the two positions they determine both keypoints' scales and
// orientations.
#pragma once

#include <algorithm>
#include <cmath>

#include "victorious/geometry/angles.h"

namespace victorious {

/// Measures of the pair (i, j); d is the vector from keypoint i to keypoint j.
struct PairMeasures {
  double scale_ratio = 1;                   ///< s_i / s_j
  double mean_scale_to_distance = 0;        ///< (s_i + s_j) / (2 |d|); infinite if the two positions coincide
  double orientation_difference_rad = 0;    ///< theta_a = o_j - o_i, wrapped
  double mean_orientation_to_line_rad = 0;  ///< theta_b = direction of d - mean orientation, wrapped
};

/// The mean of two orientations is the middle of the shorter arc from o_i to o_j. For opposite orientations both arcs
/// are equally long and the mean is ambiguous by pi: compare such measures with MeanOrientationDistortion, which is
/// invariant to it.
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

/// The distortion of a ratio (thesis, section 3.3.3): max(a/b, b/a) >= 1.
inline double RatioDistortion(double a, double b) { return std::max(a / b, b / a); }

/// The distortion of theta_a: the absolute wrapped difference. A ratio of angles is meaningless near 0.
inline double OrientationDistortion(const PairMeasures& a, const PairMeasures& b) {
  return std::abs(WrapAngle(a.orientation_difference_rad - b.orientation_difference_rad));
}

/// The distortion of theta_b. If the orientations are nearly opposite in both pairs, noise may put the shorter arcs on
/// opposite sides, so that the two means differ by pi; this half turn is then removed.
inline double MeanOrientationDistortion(const PairMeasures& a, const PairMeasures& b) {
  const bool opposite_sides =
      // the shorter arc between them wraps
      std::abs(a.orientation_difference_rad - b.orientation_difference_rad) > kPi;
  const double half_turn = opposite_sides ? kPi : 0.0;
  return std::abs(WrapAngle(a.mean_orientation_to_line_rad - b.mean_orientation_to_line_rad + half_turn));
}

}  // namespace victorious

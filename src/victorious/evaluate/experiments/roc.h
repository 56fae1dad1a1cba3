// Receiver operating characteristic: of a score's every threshold, how many of the wanted and of the others pass it.
#pragma once

#include <span>
#include <vector>

namespace victorious {

struct RocPoint {
  double false_alarms = 0;  ///< share of the others above the threshold
  double detections = 0;    ///< share of the wanted above it
};

/// From (0, 0) to (1, 1), a point a threshold; equal scores pass together. Of both kinds at least one.
std::vector<RocPoint> RocCurve(std::span<const double> scores, const std::vector<bool>& wanted);

/// The area under the curve: how often a wanted one scores above another one; equal scores count half.
double RocArea(std::span<const double> scores, const std::vector<bool>& wanted);

/// The curve's height at a share of false alarms, linear between its points.
double DetectionsAt(std::span<const RocPoint> curve, double false_alarms);

}  // namespace victorious

// Receiver operating characteristic: the rates of detections and false alarms at each threshold of a score.
#pragma once

#include <span>
#include <vector>

namespace victorious {

struct RocPoint {
  double false_alarms = 0;  ///< fraction of the negatives above the threshold
  double detections = 0;    ///< fraction of the positives above the threshold
};

/// Returns the curve from (0, 0) to (1, 1), one point per distinct score.
/// @param scores  at least one of a positive and one of a negative
/// @param is_positive  whether each score belongs to a positive
std::vector<RocPoint> RocCurve(std::span<const double> scores, const std::vector<bool>& is_positive);

/// The area under the curve (AUC): the probability that a positive scores above a negative; ties count half.
double RocArea(std::span<const double> scores, const std::vector<bool>& is_positive);

/// The detection rate at a false alarm rate, linearly interpolated.
double DetectionRateAt(std::span<const RocPoint> curve, double false_alarms);

}  // namespace victorious

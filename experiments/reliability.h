// Calibration of detection scores: the reliability diagram, the expected calibration error, and the fit of the logistic
// curve that maps -log10 NFA to a probability (Platt 1999).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace victorious {

/// A detection with its truth label.
struct LabelledDetection {
  double neg_log10_nfa = 0;  ///< -log10 NFA
  double score = 0;          ///< 0 to 1
  bool correct = false;
};

/// The detections within one interval of the score.
struct ReliabilityBin {
  std::size_t count = 0;
  double mean_score = 0;
  double correct = 0;         ///< fraction of true detections
  double standard_error = 0;  ///< of that fraction (binomial)
};

inline constexpr int kReliabilityBins = 10;

/// kReliabilityBins bins of equal width over [0, 1].
[[nodiscard]] std::vector<ReliabilityBin> Reliability(std::span<const LabelledDetection> labelled);

/// The expected calibration error (ECE): the mean of |mean score - fraction of true detections| over the bins, weighted
/// by their counts; 0 for an empty span.
[[nodiscard]] double CalibrationError(std::span<const LabelledDetection> labelled);

/// The logistic curve p(e) = 1 / (1 + exp(-(e - e0) / s)) of e = -log10 NFA.
struct Logistic {
  double midpoint = 0;  ///< e0, where the probability is 0.5
  double scale = 1;     ///< s, > 0

  [[nodiscard]] double Probability(double neg_log10_nfa) const;
};

/// Fits the curve by maximum likelihood with Newton's method (Platt 1999). A weak Gaussian prior on the slope keeps it
/// finite for separable data. Platt's regularisation, targets short of 0 and 1, would flatten the curve, because the
/// significance of true detections has no upper bound. If all labels are equal, the curve is nearly flat.
[[nodiscard]] Logistic FitLogistic(std::span<const LabelledDetection> labelled);

/// Leave-one-group-out cross-validation: scores each group by the curve fitted to all other groups. Returns one empty
/// group if there is a single group.
[[nodiscard]] std::vector<std::vector<LabelledDetection>> CrossValidate(
    const std::vector<std::vector<LabelledDetection>>& groups);

}  // namespace victorious

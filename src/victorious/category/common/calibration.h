// Calibration: maps the raw score of a classifier to a probability.
// Source: J. Platt, "Probabilistic outputs for support vector machines and comparisons to regularized likelihood
// methods", 2000.
#pragma once

#include <span>
#include <vector>

namespace victorious {

/// Maps a score to a probability: 1 / (1 + exp(-(slope score + offset))).
struct Calibration {
  double slope = 1;
  double offset = 0;

  [[nodiscard]] double LogOdds(double score) const { return slope * score + offset; }
  [[nodiscard]] double Probability(double score) const;
};

/// Platt scaling (2000) by Newton's method, with his softened targets. Both classes have equal total weight, so that
/// probability 0.5 lies between them independently of their sizes. The slope is positive even for uninformative scores.
/// @param positive  the class of each score
/// @pre at least one score of each class
Calibration Calibrate(std::span<const double> scores, const std::vector<bool>& positive);

}  // namespace victorious

// How well scores are probabilities, and the curve that makes them so.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace victorious {

/// A detection whose truth is known.
struct Judged {
  double evidence = 0;  ///< decades
  double score = 0;     ///< 0 to 1
  bool right = false;
};

/// The detections of about one score.
struct ReliabilityBin {
  std::size_t count = 0;
  double mean_score = 0;
  double right = 0;           ///< share
  double standard_error = 0;  ///< of that share
};

inline constexpr int kReliabilityBins = 10;

/// kReliabilityBins bins of equal width over [0, 1].
[[nodiscard]] std::vector<ReliabilityBin> Reliability(std::span<const Judged> judged);

/// The expected calibration error: the mean of |mean score - share right| over the bins, by their counts. 0 for none.
[[nodiscard]] double CalibrationError(std::span<const Judged> judged);

/// 1 / (1 + exp(-(evidence - even) / scale)).
struct Logistic {
  double even = 0;   ///< decades
  double scale = 1;  ///< decades, > 0

  [[nodiscard]] double ScoreOf(double evidence) const;
};

/// The most likely curve, by Newton's method (Platt 1999), with a weak prior on its slope, so that data that can be
/// parted leave it finite. Platt's own way to that, targets short of 0 and 1, would flatten it: evidence goes far
/// beyond what any target but 1 explains. Where all are right or all wrong, a curve that says little.
[[nodiscard]] Logistic FitLogistic(std::span<const Judged> judged);

/// Each group's scores by the curve that fits all other groups; of a group alone there is nothing to fit to, and
/// nothing scored.
[[nodiscard]] std::vector<std::vector<Judged>> ScoredByOthers(const std::vector<std::vector<Judged>>& groups);

}  // namespace victorious

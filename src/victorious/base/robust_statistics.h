// Statistics of residuals that some gross errors do not spoil. Residuals are in units of their standard deviation.
// Source: P. J. Huber, Robust Statistics, 1981.
#pragma once

#include <cmath>

namespace victorious {

/// Ratio of the standard deviation to the median absolute value of a normal variate: 1 / the 75 % quantile of N(0, 1).
inline constexpr double kMadToSigma = 1.4826;

/// Huber's loss: quadratic up to the threshold, then linear.
inline double HuberLoss(double sigmas, double threshold) {
  const double size = std::abs(sigmas);
  return size <= threshold ? size * size : threshold * (2 * size - threshold);
}

/// The weight by which iterated least squares minimises Huber's loss.
inline double HuberWeight(double sigmas, double threshold) {
  const double size = std::abs(sigmas);
  return size <= threshold ? 1 : threshold / size;
}

}  // namespace victorious

// The stopping rule of random sampling (Fischler and Bolles 1981).
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>

namespace victorious {

/// Returns the number of samples of which at least one is free of outliers with the given probability:
///   log(1 - confidence) / log(1 - inlier_fraction^sample_size);
/// infinity without inliers, 1 without outliers. Not rounded.
/// @param confidence  in (0, 1)
inline double SamplesNeeded(double inlier_fraction, std::size_t sample_size, double confidence) {
  const double clean = std::pow(inlier_fraction, static_cast<double>(sample_size));
  if (clean <= 0) return std::numeric_limits<double>::infinity();
  if (clean >= 1) return 1;
  return std::log(1 - confidence) / std::log1p(-clean);
}

}  // namespace victorious

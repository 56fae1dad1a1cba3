// The median of samples, and of the Rayleigh distribution.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace victorious {

/// The median of the Rayleigh distribution with sigma 1 (the norm of two standard normal variables): sqrt(2 ln 2).
inline constexpr double kRayleighMedian = 1.1774100225154747;

/// Returns the median; for an even number of values the upper of the two middle ones; 0 for an empty vector. O(n).
inline double Median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

}  // namespace victorious

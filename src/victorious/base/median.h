// The median of numbers, and of one distribution.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace victorious {

/// The median length of two standard normal numbers: sqrt(2 ln 2).
inline constexpr double kRayleighMedian = 1.1774100225154747;

/// The middle one in order, of an even number the upper of the two in the middle; 0 of none.
inline double Median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

}  // namespace victorious

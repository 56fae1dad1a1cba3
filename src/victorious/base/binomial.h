// The binomial coefficient, as a logarithm: of large numbers it is larger than a double holds.
#pragma once

#include <cmath>

namespace victorious {

/// ln C(n, k), 0 <= k <= n; by the gamma function, so that neither need be whole.
inline double LogChoose(double n, double k) {
  int sign = 0;  // std::lgamma puts it into a global, where threads meet
  return ::lgamma_r(n + 1, &sign) - ::lgamma_r(k + 1, &sign) - ::lgamma_r(n - k + 1, &sign);
}

}  // namespace victorious

// The logarithm of the binomial coefficient, which itself exceeds the range of a double for large n.
#pragma once

#include <cmath>

namespace victorious {

/// Returns ln C(n, k), 0 <= k <= n, by the log-gamma function, so that n and k need not be integers.
inline double LogChoose(double n, double k) {
  int sign = 0;  // std::lgamma writes it to a global variable: a data race
  return ::lgamma_r(n + 1, &sign) - ::lgamma_r(k + 1, &sign) - ::lgamma_r(n - k + 1, &sign);
}

}  // namespace victorious

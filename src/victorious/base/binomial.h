// The binomial coefficient, as a logarithm: of large numbers it is larger than a double holds.
#pragma once

#include <cmath>

namespace victorious {

/// ln C(n, k), 0 <= k <= n; by the gamma function, so that neither need be whole.
inline double LogChoose(double n, double k) { return std::lgamma(n + 1) - std::lgamma(k + 1) - std::lgamma(n - k + 1); }

}  // namespace victorious

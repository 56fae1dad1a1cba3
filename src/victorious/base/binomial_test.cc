#include "victorious/base/binomial.h"

#include <cmath>

#include <gtest/gtest.h>

namespace victorious {
namespace {

TEST(LogChoose, MatchesPascalsTriangle) {
  EXPECT_NEAR(std::exp(LogChoose(49, 6)), 13983816, 1e-4);
  for (int n = 1; n <= 60; ++n) {
    EXPECT_NEAR(LogChoose(n, 0), 0, 1e-12);
    EXPECT_NEAR(LogChoose(n, n), 0, 1e-12);
    for (int k = 1; k < n; ++k) {
      const double sum = std::exp(LogChoose(n - 1, k - 1)) + std::exp(LogChoose(n - 1, k));
      EXPECT_NEAR(std::exp(LogChoose(n, k)) / sum, 1, 1e-12) << n << ", " << k;
    }
  }
}

TEST(LogChoose, HandlesCoefficientsBeyondDoubleRange) {
  EXPECT_NEAR(LogChoose(1e5, 5e4) / (1e5 * std::log(2.0)), 1, 1e-4);
}

}  // namespace
}  // namespace victorious

#include "victorious/category/common/calibration.h"

#include <cmath>

#include <gtest/gtest.h>

namespace victorious {
namespace {

TEST(Calibration, EqualsPositiveFractionAmongEqualScores) {
  // 8 of 10 examples of score 1 are positive, and 2 of 10 of score -1.
  std::vector<double> scores;
  std::vector<bool> positive;
  for (int i = 0; i < 1000; ++i) {
    scores.push_back(i % 2 == 0 ? 1 : -1);
    positive.push_back(i % 2 == 0 ? i % 20 < 16 : i % 20 >= 16);
  }
  const Calibration calibration = Calibrate(scores, positive);
  EXPECT_NEAR(calibration.Probability(1), 0.8, 0.02);
  EXPECT_NEAR(calibration.Probability(-1), 0.2, 0.02);
}

TEST(Calibration, IsMonotonicAndFiniteForAnyScores) {
  for (const std::vector<double>& scores :
       {std::vector<double>{0, 0, 0, 0}, {1, 1, -1, -1}, {-1, -1, 1, 1}, {1e9, 1e9, 0, 0}}) {
    const Calibration calibration = Calibrate(scores, {true, true, false, false});
    EXPECT_GT(calibration.slope, 0);
    EXPECT_TRUE(std::isfinite(calibration.slope) && std::isfinite(calibration.offset));
  }
}

}  // namespace
}  // namespace victorious

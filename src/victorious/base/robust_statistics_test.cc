#include "victorious/base/robust_statistics.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "victorious/base/median.h"
#include "victorious/base/random.h"

namespace victorious {
namespace {

TEST(HuberLoss, IsQuadraticThenLinear) {
  EXPECT_EQ(HuberLoss(0, 2), 0);
  EXPECT_EQ(HuberLoss(-1.5, 2), 2.25);
  EXPECT_EQ(HuberLoss(2, 2), 4);
  EXPECT_EQ(HuberLoss(5, 2) - HuberLoss(4, 2), HuberLoss(-6, 2) - HuberLoss(-5, 2));
}

// Weighted least squares has the gradient 2 w x.
TEST(HuberWeight, GivesTheGradientOfTheLoss) {
  constexpr double kStep = 1e-6;
  for (const double sigmas : {-7.0, -2.5, -1.0, 0.3, 1.9, 2.1, 40.0}) {
    const double slope = (HuberLoss(sigmas + kStep, 2) - HuberLoss(sigmas - kStep, 2)) / (2 * kStep);
    EXPECT_NEAR(2 * HuberWeight(sigmas, 2) * sigmas, slope, 1e-6) << sigmas;
  }
}

TEST(MadToSigma, GivesTheStandardDeviationOfNormalVariates) {
  Random random(1);
  std::vector<double> sizes(100'000);
  for (double& size : sizes) size = std::abs(3 * random.Normal());
  EXPECT_NEAR(kMadToSigma * Median(std::move(sizes)), 3, 0.03);
}

}  // namespace
}  // namespace victorious

#include "experiments/reliability.h"

#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "victorious/base/random.h"

namespace victorious {
namespace {

// Draws detections that are true with the probability of `truth`, scored with the second curve.
std::vector<LabelledDetection> Draw(const Logistic& truth, const Logistic& scoring, std::uint64_t seed) {
  Random random(seed);
  std::vector<LabelledDetection> labelled;
  for (int i = 0; i < 20000; ++i) {
    const double neg_log10_nfa = 20 * random.Uniform() - 8;
    labelled.push_back(
        {neg_log10_nfa, scoring.Probability(neg_log10_nfa), random.Uniform() < truth.Probability(neg_log10_nfa)});
  }
  return labelled;
}

TEST(Reliability, TrueProbabilitiesHaveZeroError) {
  const Logistic truth{2, 1.5};
  EXPECT_LT(CalibrationError(Draw(truth, truth, 1)), 0.01);
}

TEST(Reliability, BiasedProbabilitiesHaveTheirError) {
  std::vector<LabelledDetection> labelled;
  for (int i = 0; i < 100; ++i) labelled.push_back({0, 0.95, i < 70});
  for (int i = 0; i < 100; ++i) labelled.push_back({0, 0.15, i < 25});
  EXPECT_NEAR(CalibrationError(labelled), 0.5 * 0.25 + 0.5 * 0.10, 1e-9);
  const auto bins = Reliability(labelled);
  EXPECT_EQ(bins[9].count, 100U);
  EXPECT_NEAR(bins[9].correct, 0.7, 1e-9);
  EXPECT_EQ(bins[4].count, 0U);
  EXPECT_EQ(CalibrationError({}), 0);
}

TEST(Reliability, FitRecoversTheCurve) {
  const Logistic truth{2, 1.5};
  const Logistic fitted = FitLogistic(Draw(truth, {0, 1}, 2));
  EXPECT_NEAR(fitted.midpoint, truth.midpoint, 0.15);
  EXPECT_NEAR(fitted.scale, truth.scale, 0.15);
}

TEST(Reliability, SeparableDataGiveAFiniteFit) {
  std::vector<LabelledDetection> labelled;
  for (int i = 0; i < 20; ++i) labelled.push_back({i < 10 ? 0.0 : 10.0, 0, i >= 10});
  const Logistic fitted = FitLogistic(labelled);
  EXPECT_NEAR(fitted.midpoint, 5, 0.5);
  EXPECT_GT(fitted.scale, 0.1);
  for (LabelledDetection& one : labelled) one.correct = true;
  const Logistic all_right = FitLogistic(labelled);
  EXPECT_TRUE(std::isfinite(all_right.midpoint) && std::isfinite(all_right.scale));
  EXPECT_GT(all_right.Probability(0), 0.5);
}

// Two groups drawn from different curves: each is scored with the other's curve.
TEST(Reliability, HeldOutGroupIsScoredByTheOthers) {
  const Logistic first{2, 1.5};
  const Logistic second{5, 0.8};
  const auto scored = CrossValidate({Draw(first, {0, 1}, 3), Draw(second, {0, 1}, 4)});
  for (const auto& [group, curve] : {std::pair(scored[0], second), std::pair(scored[1], first)}) {
    for (const LabelledDetection& one : group) ASSERT_NEAR(one.score, curve.Probability(one.neg_log10_nfa), 0.05);
  }
  EXPECT_TRUE(CrossValidate({Draw(first, {0, 1}, 5)})[0].empty()) << "no others";
}

}  // namespace
}  // namespace victorious

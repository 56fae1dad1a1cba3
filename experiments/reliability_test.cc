#include "experiments/reliability.h"

#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "victorious/base/random.h"

namespace victorious {
namespace {

// Draws detections that are true with the probability of `truth`, scored with the second curve.
std::vector<Judged> Draw(const Logistic& truth, const Logistic& told, std::uint64_t seed) {
  Random random(seed);
  std::vector<Judged> judged;
  for (int i = 0; i < 20000; ++i) {
    const double evidence = 20 * random.Uniform() - 8;
    judged.push_back({evidence, told.ScoreOf(evidence), random.Uniform() < truth.ScoreOf(evidence)});
  }
  return judged;
}

TEST(Reliability, TrueProbabilitiesHaveNoError) {
  const Logistic truth{2, 1.5};
  EXPECT_LT(CalibrationError(Draw(truth, truth, 1)), 0.01);
}

TEST(Reliability, WrongOnesHaveTheirs) {
  std::vector<Judged> judged;
  for (int i = 0; i < 100; ++i) judged.push_back({0, 0.95, i < 70});
  for (int i = 0; i < 100; ++i) judged.push_back({0, 0.15, i < 25});
  EXPECT_NEAR(CalibrationError(judged), 0.5 * 0.25 + 0.5 * 0.10, 1e-9);
  const auto bins = Reliability(judged);
  EXPECT_EQ(bins[9].count, 100U);
  EXPECT_NEAR(bins[9].right, 0.7, 1e-9);
  EXPECT_EQ(bins[4].count, 0U);
  EXPECT_EQ(CalibrationError({}), 0);
}

TEST(Reliability, TheFittedCurveIsTheOneThatDrew) {
  const Logistic truth{2, 1.5};
  const Logistic fitted = FitLogistic(Draw(truth, {0, 1}, 2));
  EXPECT_NEAR(fitted.even, truth.even, 0.15);
  EXPECT_NEAR(fitted.scale, truth.scale, 0.15);
}

TEST(Reliability, DataThatCanBePartedLeaveTheCurveFinite) {
  std::vector<Judged> judged;
  for (int i = 0; i < 20; ++i) judged.push_back({i < 10 ? 0.0 : 10.0, 0, i >= 10});
  const Logistic fitted = FitLogistic(judged);
  EXPECT_NEAR(fitted.even, 5, 0.5);
  EXPECT_GT(fitted.scale, 0.1);
  for (Judged& one : judged) one.right = true;
  const Logistic all_right = FitLogistic(judged);
  EXPECT_TRUE(std::isfinite(all_right.even) && std::isfinite(all_right.scale));
  EXPECT_GT(all_right.ScoreOf(0), 0.5);
}

// Two groups drawn from different curves: each is scored with the other's curve.
TEST(Reliability, AHeldOutGroupIsScoredByTheOthers) {
  const Logistic first{2, 1.5};
  const Logistic second{5, 0.8};
  const auto scored = ScoredByOthers({Draw(first, {0, 1}, 3), Draw(second, {0, 1}, 4)});
  for (const auto& [group, curve] : {std::pair(scored[0], second), std::pair(scored[1], first)}) {
    for (const Judged& one : group) ASSERT_NEAR(one.score, curve.ScoreOf(one.evidence), 0.05);
  }
  EXPECT_TRUE(ScoredByOthers({Draw(first, {0, 1}, 5)})[0].empty()) << "no others";
}

}  // namespace
}  // namespace victorious

#include "victorious/category/ridge.h"

#include <cmath>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "victorious/base/random.h"

namespace victorious {
namespace {

struct Problem {
  Eigen::MatrixXd kernel;
  std::vector<int> target;
  std::vector<int> group;
};

Problem RandomProblem(std::uint64_t seed) {
  Random random(seed);
  Eigen::MatrixXd x(24, 5);
  Problem problem;
  for (Eigen::Index i = 0; i < x.rows(); ++i) {
    problem.target.push_back(i % 3 == 0 ? 1 : -1);
    problem.group.push_back(static_cast<int>(i / 2));
    for (Eigen::Index k = 0; k < x.cols(); ++k) x(i, k) = random.Normal() + 0.7 * problem.target.back();
  }
  problem.kernel = x * x.transpose();
  problem.kernel.array() += 1;
  return problem;
}

TEST(Ridge, HeldOutScoresAreThoseOfTrainingWithoutTheGroup) {
  const Problem problem = RandomProblem(1);
  const double lambda = 0.7;
  const RidgeFit fit = FitRidge(problem.kernel, problem.target, problem.group, lambda);
  // With the penalties of the whole, the others alone.
  const double positives = 8;
  const double count = 24;
  for (const int left_out : {0, 5, 11}) {
    std::vector<Eigen::Index> others;
    for (Eigen::Index i = 0; i < 24; ++i)
      if (problem.group[static_cast<std::size_t>(i)] != left_out) others.push_back(i);
    Eigen::MatrixXd system = problem.kernel(others, others);
    Eigen::VectorXd y(system.rows());
    for (Eigen::Index i = 0; i < y.size(); ++i) {
      y(i) = problem.target[static_cast<std::size_t>(others[static_cast<std::size_t>(i)])];
      system(i, i) += lambda * 2 * (y(i) > 0 ? positives : count - positives) / count;
    }
    const Eigen::VectorXd alpha = system.ldlt().solve(y);
    for (const Eigen::Index i : {2 * left_out, 2 * left_out + 1})
      EXPECT_NEAR(fit.held_out(i), problem.kernel(i, others).dot(alpha), 1e-9);
  }
}

TEST(Ridge, ScoresExamplesThatItDoesNotLearnFrom) {
  Problem problem = RandomProblem(2);
  problem.target[3] = 0;
  const RidgeFit fit = FitRidge(problem.kernel, problem.target, problem.group, 0.5);
  EXPECT_EQ(fit.alpha(3), 0);
  EXPECT_NE(fit.held_out(3), 0);
}

TEST(Calibration, IsTheShareOfPositivesAmongEqualScores) {
  // Of the score 1, 8 of 10 are positive; of the score -1, 2 of 10.
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

TEST(Calibration, StaysRisingAndFiniteWhateverTheScores) {
  for (const std::vector<double>& scores :
       {std::vector<double>{0, 0, 0, 0}, {1, 1, -1, -1}, {-1, -1, 1, 1}, {1e9, 1e9, 0, 0}}) {
    const Calibration calibration = Calibrate(scores, {true, true, false, false});
    EXPECT_GT(calibration.slope, 0);
    EXPECT_TRUE(std::isfinite(calibration.slope) && std::isfinite(calibration.offset));
  }
}

}  // namespace
}  // namespace victorious

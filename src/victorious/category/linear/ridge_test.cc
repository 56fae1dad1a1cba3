#include "victorious/category/linear/ridge.h"

#include <cmath>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "victorious/base/random.h"

namespace victorious {
namespace {

struct Problem {
  Eigen::MatrixXd kernel;
  Eigen::MatrixXi targets;  // two problems
  std::vector<int> group;
  Eigen::VectorXd penalty;
};

Problem RandomProblem(std::uint64_t seed) {
  Random random(seed);
  Eigen::MatrixXd x(24, 5);
  Problem problem{.kernel = {}, .targets = Eigen::MatrixXi(24, 2), .group = {}, .penalty = Eigen::VectorXd(24)};
  for (Eigen::Index i = 0; i < x.rows(); ++i) {
    problem.targets.row(i) << (i % 3 == 0 ? 1 : -1), (i % 4 == 0 ? 1 : -1);
    problem.penalty(i) = random.Uniform(0.3, 1.5);
    problem.group.push_back(static_cast<int>(i / 2));
    for (Eigen::Index k = 0; k < x.cols(); ++k) x(i, k) = random.Normal() + 0.7 * problem.targets(i, 0);
  }
  problem.kernel = x * x.transpose();
  problem.kernel.array() += 1;
  return problem;
}

TEST(Ridge, HeldOutScoresEqualTrainingWithoutTheGroup) {
  const Problem problem = RandomProblem(1);
  const RidgeFit fit = FitRidge(problem.kernel, problem.targets, problem.group, problem.penalty);
  for (const int left_out : {0, 5, 11}) {
    std::vector<Eigen::Index> others;
    for (Eigen::Index i = 0; i < 24; ++i)
      if (problem.group[static_cast<std::size_t>(i)] != left_out) others.push_back(i);
    Eigen::MatrixXd system = problem.kernel(others, others);
    system.diagonal() += problem.penalty(others);
    const Eigen::MatrixXd alpha = system.ldlt().solve(problem.targets(others, Eigen::all).cast<double>());
    for (const Eigen::Index i : {2 * left_out, 2 * left_out + 1})
      EXPECT_LT((fit.held_out.row(i) - problem.kernel(i, others) * alpha).norm(), 1e-9);
  }
}

TEST(Ridge, HeldOutScoresIncludeExamplesWithoutTarget) {
  Problem problem = RandomProblem(2);
  problem.targets.row(3).setZero();
  const RidgeFit fit = FitRidge(problem.kernel, problem.targets, problem.group, problem.penalty);
  EXPECT_EQ(fit.alpha.row(3).norm(), 0);
  EXPECT_NE(fit.held_out(3, 1), 0);
}

}  // namespace
}  // namespace victorious

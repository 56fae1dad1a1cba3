#include "victorious/geometry/robust/mlesac.h"

#include <gtest/gtest.h>

#include "victorious/geometry/angles.h"
#include "victorious/geometry/robust/similarity_estimator.h"

namespace victorious {
namespace {

struct Problem {
  Similarity2 truth;
  std::vector<PointPair> pairs;
  std::size_t inliers;
};

Problem MakeProblem(std::size_t inliers, std::size_t outliers, double noise_px, std::uint64_t seed) {
  Random random(seed);
  Problem problem{{std::exp(random.Uniform(-1, 1)),
                   random.Uniform(-kPi, kPi),
                   {random.Uniform(100, 500), random.Uniform(100, 300)}},
                  {},
                  inliers};
  for (std::size_t i = 0; i < inliers + outliers; ++i) {
    const Eigen::Vector2d source(random.Uniform(0, 100), random.Uniform(0, 100));
    const Eigen::Vector2d noise(random.Normal(), random.Normal());
    const Eigen::Vector2d anywhere(random.Uniform(0, 640), random.Uniform(0, 480));
    problem.pairs.push_back({source, i < inliers ? problem.truth.Apply(source) + noise_px * noise : anywhere});
  }
  return problem;
}

double WorstCornerError(const Similarity2& a, const Similarity2& b) {
  double worst = 0;
  for (const Eigen::Vector2d& corner :
       {Eigen::Vector2d(0, 0), Eigen::Vector2d(100, 0), Eigen::Vector2d(0, 100), Eigen::Vector2d(100, 100)}) {
    worst = std::max(worst, (a.Apply(corner) - b.Apply(corner)).norm());
  }
  return worst;
}

MlesacOptions Settings() { return {.outlier_area_px2 = 640.0 * 480.0}; }

TEST(Mlesac, FindsTheSimilarityAmongOutliers) {
  int good = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const Problem problem = MakeProblem(12, 12, 1.0, seed);
    const SimilarityEstimator estimator(problem.pairs, {.noise_px = 1.5, .shape_px = 0});
    const auto result = Mlesac(estimator, Settings());
    ASSERT_TRUE(result.has_value()) << seed;
    if (WorstCornerError(result->model, problem.truth) < 3) ++good;
  }
  EXPECT_GE(good, 199);
}

TEST(Mlesac, GammaIsTheInlierFraction) {
  const Problem problem = MakeProblem(60, 40, 1.0, 9);
  const SimilarityEstimator estimator(problem.pairs, {.noise_px = 1.0, .shape_px = 0});
  const auto result = Mlesac(estimator, Settings());
  ASSERT_TRUE(result.has_value());
  EXPECT_NEAR(result->gamma, 0.6, 0.05);
  int right = 0;
  for (std::size_t i = 0; i < 100; ++i) right += (result->probabilities[i] > 0.5) == (i < 60) ? 1 : 0;
  EXPECT_GE(right, 97);
}

TEST(Mlesac, IsDeterministicBySeedAndRobustToOrder) {
  const Problem problem = MakeProblem(40, 60, 1.0, 4);
  const SimilarityEstimator estimator(problem.pairs, {.noise_px = 1.5, .shape_px = 0});
  const auto first = Mlesac(estimator, Settings());
  const auto second = Mlesac(estimator, Settings());
  EXPECT_EQ(first->model.Matrix(), second->model.Matrix());
  EXPECT_EQ(first->hypotheses, second->hypotheses);
  std::vector<PointPair> reversed(problem.pairs.rbegin(), problem.pairs.rend());
  const auto third = Mlesac(SimilarityEstimator(reversed, {.noise_px = 1.5, .shape_px = 0}), Settings());
  EXPECT_LT(WorstCornerError(first->model, third->model), 0.05);  // the refinement converges to the same optimum
}

TEST(Mlesac, DegenerateDataGiveNoResult) {
  const std::vector<PointPair> one_place(8, {{1, 2}, {3, 4}});
  EXPECT_FALSE(Mlesac(SimilarityEstimator(one_place, {}), Settings()).has_value());
  EXPECT_FALSE(Mlesac(SimilarityEstimator(std::span(one_place).first(1), {}), Settings()).has_value());
}

}  // namespace
}  // namespace victorious

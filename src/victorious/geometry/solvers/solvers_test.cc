#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/homography.h"
#include "victorious/geometry/solvers/plane_maps.h"
#include "victorious/geometry/solvers/similarity.h"

namespace victorious {
namespace {

std::vector<PointPair> PairsUnder(const Eigen::Matrix3d& map, int count, Random& random) {
  std::vector<PointPair> pairs;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector2d source(random.Uniform(0, 300), random.Uniform(0, 200));
    pairs.push_back({source, ApplyHomography(map, source)});
  }
  return pairs;
}

Eigen::Matrix3d RandomHomography(Random& random) {
  Eigen::Matrix3d map;
  map << random.Uniform(0.5, 2), random.Uniform(-1, 1), random.Uniform(-99, 99),  //
      random.Uniform(-1, 1), random.Uniform(0.5, 2), random.Uniform(-99, 99),     //
      random.Uniform(-5e-4, 5e-4), random.Uniform(-5e-4, 5e-4), 1;
  return map;
}

TEST(Solvers, RecoverExactMaps) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    Random random(seed);
    const Similarity2 similarity{random.Uniform(0.2, 5), random.Uniform(-kPi, kPi), {random.Uniform(-99, 99), 7}};
    const auto two = PairsUnder(similarity.Matrix(), 2, random);
    ASSERT_TRUE(SolveSimilarity(two).has_value());
    EXPECT_LT((SolveSimilarity(two)->Matrix() - similarity.Matrix()).norm(), 1e-6) << seed;
    Eigen::Matrix3d affine = RandomHomography(random);
    affine.row(2) << 0, 0, 1;
    EXPECT_LT((SolveAffine(PairsUnder(affine, 5, random)).value() - affine).norm(), 1e-6) << seed;
    const Eigen::Matrix3d homography = RandomHomography(random);
    EXPECT_LT((SolveHomography(PairsUnder(homography, 8, random)).value() - homography).norm(), 1e-4) << seed;
  }
}

TEST(Solvers, ZeroWeightsAreIgnored) {
  Random random(3);
  const Eigen::Matrix3d homography = RandomHomography(random);
  std::vector<PointPair> pairs = PairsUnder(homography, 12, random);
  std::vector<double> weights(pairs.size(), 1.0);
  pairs[2].target += Eigen::Vector2d(40, -30);
  weights[2] = 0;
  EXPECT_LT((SolveHomography(pairs, weights).value() - homography).norm(), 1e-4);
}

TEST(Solvers, DegenerateConfigurationsGiveNoSolution) {
  std::vector<PointPair> one_place(5, {{3, 4}, {5, 6}});
  EXPECT_FALSE(SolveSimilarity(one_place).has_value());
  EXPECT_FALSE(SolveAffine(one_place).has_value());
  EXPECT_FALSE(SolveHomography(one_place).has_value());
  std::vector<PointPair> line;
  for (int i = 0; i < 6; ++i) line.push_back({{1.0 * i, 2.0 * i}, {3.0 * i, 1.0 * i}});
  EXPECT_FALSE(SolveAffine(line).has_value());
  EXPECT_FALSE(SolveHomography(line).has_value());
  EXPECT_FALSE(SolveSimilarity(std::span<const PointPair>()).has_value());
}

}  // namespace
}  // namespace victorious

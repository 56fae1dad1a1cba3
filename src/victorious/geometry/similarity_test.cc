#include "victorious/geometry/similarity.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/homography.h"

namespace victorious {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;

Similarity2 RandomSimilarity(Random& random) {
  return {.scale = std::exp(random.Uniform(-2, 2)),
          .rotation_rad = random.Uniform(-kPi, kPi),
          .translation = {random.Uniform(-100, 100), random.Uniform(-100, 100)}};
}

Vector2d RandomPoint(Random& random) { return {random.Uniform(-50, 50), random.Uniform(-50, 50)}; }

TEST(Similarity2, DefaultIsIdentity) {
  EXPECT_EQ(Similarity2{}.Apply({3, -4}), Vector2d(3, -4));
  EXPECT_EQ(Similarity2{}.Matrix(), Matrix3d::Identity());
}

TEST(Similarity2, RotationIsFromXTowardsY) {
  const Similarity2 quarter{.scale = 2, .rotation_rad = kPi / 2, .translation = {10, 20}};
  EXPECT_TRUE(quarter.Apply({1, 0}).isApprox(Vector2d(10, 22), 1e-12));
  EXPECT_TRUE(quarter.Apply({0, 1}).isApprox(Vector2d(8, 20), 1e-12));
}

TEST(Similarity2, ScalesLengthsAndKeepsAngles) {
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    SCOPED_TRACE(i);
    const Similarity2 similarity = RandomSimilarity(random);
    const Vector2d a = RandomPoint(random);
    const Vector2d b = RandomPoint(random);
    EXPECT_NEAR((similarity.Apply(a) - similarity.Apply(b)).norm(), similarity.scale * (a - b).norm(), 1e-9);
    EXPECT_NEAR(similarity.Linear().determinant(), similarity.scale * similarity.scale, 1e-9);
  }
}

TEST(Similarity2, InverseIsTwoSided) {
  Random random(2);
  for (int i = 0; i < 200; ++i) {
    SCOPED_TRACE(i);
    const Similarity2 target_from_source = RandomSimilarity(random);
    const Similarity2 source_from_target = target_from_source.Inverse();
    const Vector2d point = RandomPoint(random);
    EXPECT_LT((source_from_target.Apply(target_from_source.Apply(point)) - point).norm(), 1e-10);
    EXPECT_LT((target_from_source.Apply(source_from_target.Apply(point)) - point).norm(), 1e-10);
    EXPECT_TRUE((target_from_source.Matrix() * source_from_target.Matrix()).isIdentity(1e-10));
  }
}

TEST(Similarity2, CompositionIsTheMatrixProduct) {
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    SCOPED_TRACE(i);
    const Similarity2 c_from_b = RandomSimilarity(random);
    const Similarity2 b_from_a = RandomSimilarity(random);
    const Vector2d point = RandomPoint(random);
    const Matrix3d c_from_a = c_from_b.Matrix() * b_from_a.Matrix();
    EXPECT_LT((ApplyHomography(c_from_a, point) - c_from_b.Apply(b_from_a.Apply(point))).norm(), 1e-9);
  }
}

}  // namespace
}  // namespace victorious

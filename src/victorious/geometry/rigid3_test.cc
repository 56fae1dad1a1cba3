#include "victorious/geometry/rigid3.h"

#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

using Eigen::Vector3d;

constexpr std::uint64_t kSeed = 31;

Vector3d RandomSpacePoint(Random& random) {
  return {random.Uniform(-9, 9), random.Uniform(-9, 9), random.Uniform(-9, 9)};
}

Rigid3 RandomRigid(Random& random) {
  const Eigen::AngleAxisd turn(random.Uniform(-kPi, kPi), RandomSpacePoint(random).normalized());
  return {Eigen::Quaterniond(turn), RandomSpacePoint(random)};
}

TEST(Rigid3, RotatesThenTranslates) {
  const Rigid3 quarter{Eigen::Quaterniond(Eigen::AngleAxisd(kPi / 2, Vector3d::UnitZ())), {10, 20, 30}};
  EXPECT_LT((quarter.Apply({1, 0, 0}) - Vector3d(10, 21, 30)).norm(), 1e-12);
  EXPECT_EQ(Rigid3{}.Apply({3, -4, 5}), Vector3d(3, -4, 5));
}

TEST(Rigid3, InverseProductAndMatrixAgree) {
  Random random(kSeed);
  for (int i = 0; i < 100; ++i) {
    const Rigid3 a = RandomRigid(random);
    const Rigid3 b = RandomRigid(random);
    const Vector3d point = RandomSpacePoint(random);
    EXPECT_LT((a.Inverse().Apply(a.Apply(point)) - point).norm(), 1e-12);
    EXPECT_LT(((a * b).Apply(point) - a.Apply(b.Apply(point))).norm(), 1e-12);
    EXPECT_LT(((a * b).Matrix() - a.Matrix() * b.Matrix()).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace victorious

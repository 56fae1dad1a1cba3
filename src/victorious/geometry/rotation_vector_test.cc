#include "victorious/geometry/rotation_vector.h"

#include <gtest/gtest.h>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

TEST(RotationVector, RotatesAboutItsDirectionByItsLength) {
  EXPECT_TRUE((RotationFromVector(Vector3d(0, 0, kPi / 2)) * Vector3d::UnitX()).isApprox(Vector3d::UnitY(), 1e-12));
  EXPECT_EQ(RotationFromVector(Vector3d::Zero()).w(), 1);
}

TEST(RotationVector, RoundTrips) {
  for (const Vector3d& vector :
       {Vector3d(0.3, -0.2, 0.9), Vector3d(1e-12, 0, 0), Vector3d(0, 3.1, 0), Vector3d(-1e-5, 2e-5, 1e-5)}) {
    EXPECT_TRUE(VectorFromRotation(RotationFromVector(vector)).isApprox(vector, 1e-9)) << vector.transpose();
  }
  EXPECT_EQ(VectorFromRotation(Quaterniond::Identity()), Vector3d::Zero());
}

TEST(RotationVector, IsTheShorterRotation) {
  EXPECT_TRUE(
      VectorFromRotation(RotationFromVector(Vector3d(0, 0, 1.5 * kPi))).isApprox(Vector3d(0, 0, -0.5 * kPi), 1e-9));
  Quaterniond turn = RotationFromVector(Vector3d(0.1, 0.2, 0.3));
  turn.coeffs() *= -1;  // the same rotation
  EXPECT_TRUE(VectorFromRotation(turn).isApprox(Vector3d(0.1, 0.2, 0.3), 1e-9));
}

TEST(RotationVector, SkewMatrixIsTheCrossProduct) {
  const Vector3d a(1, -2, 3);
  const Vector3d b(0.5, 4, -1);
  EXPECT_TRUE((CrossProductMatrix(a) * b).isApprox(a.cross(b), 1e-12));
}

}  // namespace
}  // namespace victorious

#include "victorious/place/geolocate/error_ellipse.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

using Eigen::Matrix2d;

TEST(CircularError, OfACircleIsRayleigh) {
  // 1 - exp(-r^2 / 2) = 0.9 at r = sqrt(2 ln 10).
  EXPECT_NEAR(CircularError(4 * Matrix2d::Identity(), 0.9), 2 * std::sqrt(2 * std::log(10.0)), 1e-9);
}

TEST(CircularError, OfALineIsNormal) {
  EXPECT_NEAR(CircularError(Eigen::Vector2d(9, 0).asDiagonal(), 0.9), 3 * 1.6448536, 1e-2);
}

TEST(CircularError, ContainsNominalFractionForAnyEllipse) {
  Random random(7);
  for (const double ratio : {0.05, 0.3, 0.7}) {
    Matrix2d root;
    root << 3, 1, 0, 3 * ratio;
    const double radius = CircularError(root * root.transpose(), 0.9);
    constexpr int kDraws = 40000;
    int inside = 0;
    for (int i = 0; i < kDraws; ++i) {
      const double x = random.Normal();
      inside += (root * Eigen::Vector2d(x, random.Normal())).norm() <= radius ? 1 : 0;
    }
    EXPECT_NEAR(inside / static_cast<double>(kDraws), 0.9, 0.006) << ratio;
  }
}

// The definition: bisection of the mean over the angle.
double CircularErrorByBisection(double long_axis, double short_axis, double probability) {
  const auto within = [&](double radius) {
    constexpr int kSteps = 256;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) {
      const double psi = (i + 0.5) * kPi / 2 / kSteps;
      const double a = long_axis * std::cos(psi);
      const double b = short_axis * std::sin(psi);
      sum -= std::expm1(-radius * radius / (2 * (a * a + b * b)));
    }
    return sum / kSteps;
  };
  double inside = 0;
  double outside = long_axis * std::sqrt(-2 * std::log1p(-probability));
  for (int i = 0; i < 60; ++i) {
    const double middle = (inside + outside) / 2;
    (within(middle) < probability ? inside : outside) = middle;
  }
  return outside;
}

TEST(CircularError, IsTheDefinition) {
  Random random(11);
  for (int i = 0; i < 300; ++i) {
    const double long_axis = std::exp(4 * random.Normal());
    const double short_axis = i % 10 == 0 ? 0 : long_axis * std::pow(random.Uniform(), 3);
    const Matrix2d covariance = Eigen::Vector2d(long_axis * long_axis, short_axis * short_axis).asDiagonal();
    const Eigen::SelfAdjointEigenSolver<Matrix2d> axes(covariance, Eigen::EigenvaluesOnly);
    const double probability = i % 3 == 0 ? 0.5 + 0.4999 * random.Uniform() : 0.9;
    const double expected = CircularErrorByBisection(std::sqrt(axes.eigenvalues()(1)),
                                                     std::sqrt(std::max(0.0, axes.eigenvalues()(0))), probability);
    EXPECT_NEAR(CircularError(covariance, probability) / expected, 1, 1e-12)
        << long_axis << " " << short_axis << " " << probability;
  }
}

TEST(LinearError90, IsTheNormalQuantile) { EXPECT_NEAR(LinearError90(4), 2 * 1.6448536, 1e-6); }

}  // namespace
}  // namespace victorious

#include "victorious/geolocate/error_ellipse.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

// The probability within radius r of a normal distribution with axes a >= b. With polar angle phi from the long axis,
// the normal density integrates over the radius in closed form:
//   1 / (2 pi a b)  int (1 - exp(-r^2 g / 2)) / g dphi,  g = cos^2 / a^2 + sin^2 / b^2.
// For elongated ellipses the mass concentrates at phi near 0. The substitution tan(phi) = (b / a) tan(psi) spreads it
// evenly, and leaves the mean over psi of 1 - exp(-r^2 / (2 (a^2 cos^2 psi + b^2 sin^2 psi))).
double ProbabilityWithin(double radius, double long_axis, double short_axis) {
  constexpr int kSteps = 256;  // of a periodic function: the error falls exponentially with the number of steps
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double psi = (i + 0.5) * kPi / 2 / kSteps;
    const double a = long_axis * std::cos(psi);
    const double b = short_axis * std::sin(psi);
    sum -= std::expm1(-radius * radius / (2 * (a * a + b * b)));
  }
  return sum / kSteps;
}

}  // namespace

double CircularError(const Eigen::Matrix2d& covariance, double probability) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(covariance, Eigen::EigenvaluesOnly);
  const double long_axis = std::sqrt(std::max(0.0, axes.eigenvalues()(1)));
  const double short_axis = std::sqrt(std::max(0.0, axes.eigenvalues()(0)));
  if (!(long_axis > 0)) return 0;
  double inside = 0;
  // for a circle with the long axis as radius: an upper bound
  double outside = long_axis * std::sqrt(-2 * std::log1p(-probability));
  for (int i = 0; i < 60; ++i) {
    const double middle = (inside + outside) / 2;
    (ProbabilityWithin(middle, long_axis, short_axis) < probability ? inside : outside) = middle;
  }
  return outside;
}

double LinearError90(double variance) {
  constexpr double kSigmas90 = 1.6448536269514722;
  return kSigmas90 * std::sqrt(std::max(0.0, variance));
}

}  // namespace victorious

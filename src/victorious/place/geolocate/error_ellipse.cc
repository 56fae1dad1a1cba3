#include "victorious/place/geolocate/error_ellipse.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include <Eigen/Eigenvalues>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

// The probability within radius r of a normal distribution with axes a >= b. With polar angle phi from the long axis,
// the normal density integrates over the radius in closed form:
//   1 / (2 pi a b)  int (1 - exp(-r^2 g / 2)) / g dphi,  g = cos^2 / a^2 + sin^2 / b^2.
// For elongated ellipses the mass concentrates at phi near 0. The substitution tan(phi) = (b / a) tan(psi) spreads it
// evenly, and leaves the mean over psi of 1 - exp(-r^2 / (2 (a^2 cos^2 psi + b^2 sin^2 psi))).
class EllipseProbability {
 public:
  EllipseProbability(double long_axis, double short_axis) {
    static const std::array<Direction, kSteps> kDirections = MakeDirections();
    for (std::size_t i = 0; i < kSteps; ++i) {
      const double a = long_axis * kDirections[i].cosine;
      const double b = short_axis * kDirections[i].sine;
      double_squares_[i] = 2 * (a * a + b * b);
    }
  }

  /// Of the circle of a radius, and its derivative.
  struct Value {
    double probability = 0;
    double density = 0;
  };
  [[nodiscard]] Value At(double radius) const {
    double sum = 0;
    double density_sum = 0;
    for (const double double_square : double_squares_) {
      const double outside = std::expm1(-radius * radius / double_square);
      sum -= outside;
      density_sum += (1 + outside) / double_square;
    }
    return {.probability = sum / kSteps, .density = 2 * radius * density_sum / kSteps};
  }

 private:
  static constexpr std::size_t kSteps = 128;  // of a periodic function: the error falls exponentially, to rounding here

  struct Direction {
    double cosine = 0;
    double sine = 0;
  };

  static std::array<Direction, kSteps> MakeDirections() {
    std::array<Direction, kSteps> directions;
    for (std::size_t i = 0; i < kSteps; ++i) {
      const double psi = (static_cast<double>(i) + 0.5) * kPi / 2 / kSteps;
      directions[i] = {std::cos(psi), std::sin(psi)};
    }
    return directions;
  }

  std::array<double, kSteps> double_squares_;
};

// By Newton's method; std::nullopt where it does not converge within (0, most].
std::optional<double> FindRadius(const EllipseProbability& ellipse, double probability, double most) {
  constexpr int kMaxSteps = 12;
  constexpr double kRounding = 1e-13;  // of a probability; some 1e-15 in fact
  double radius = most;
  for (int step = 0; step < kMaxSteps; ++step) {
    const auto [within, density] = ellipse.At(radius);
    const double off = within - probability;
    if (!(density > 0)) break;
    radius -= off / density;
    if (!(radius > 0 && radius <= most)) break;
    if (std::abs(off) < kRounding) return radius;
  }
  return std::nullopt;
}

double BisectRadius(const EllipseProbability& ellipse, double probability, double most) {
  double inside = 0;
  double outside = most;
  for (int i = 0; i < 60; ++i) {
    const double middle = (inside + outside) / 2;
    if (middle == inside || middle == outside) break;
    (ellipse.At(middle).probability < probability ? inside : outside) = middle;
  }
  return outside;
}

}  // namespace

double CircularError(const Eigen::Matrix2d& covariance, double probability) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(covariance, Eigen::EigenvaluesOnly);
  const double long_axis = std::sqrt(std::max(0.0, axes.eigenvalues()(1)));
  const double short_axis = std::sqrt(std::max(0.0, axes.eigenvalues()(0)));
  if (!(long_axis > 0)) return 0;
  const EllipseProbability ellipse(long_axis, short_axis);
  // for a circle with the long axis as radius: an upper bound
  const double most = long_axis * std::sqrt(-2 * std::log1p(-probability));
  if (const std::optional<double> radius = FindRadius(ellipse, probability, most)) return *radius;
  return BisectRadius(ellipse, probability, most);
}

double LinearError90(double variance) {
  constexpr double kSigmas90 = 1.6448536269514722;
  return kSigmas90 * std::sqrt(std::max(0.0, variance));
}

void SetErrorRadii(Geolocation& place) {
  constexpr double kProbability = 0.9;
  place.ce90_m = CircularError(place.covariance_enu_m2.topLeftCorner<2, 2>(), kProbability);
  place.le90_m = LinearError90(place.covariance_enu_m2(2, 2));
}

}  // namespace victorious

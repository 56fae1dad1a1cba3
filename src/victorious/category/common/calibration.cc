#include "victorious/category/common/calibration.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "victorious/base/check.h"

namespace victorious {

double Calibration::Probability(double score) const { return 1 / (1 + std::exp(-LogOdds(score))); }

Calibration Calibrate(std::span<const double> scores, const std::vector<bool>& positive) {
  const auto positives = static_cast<double>(std::ranges::count(positive, true));
  const double negatives = static_cast<double>(scores.size()) - positives;
  VICTORIOUS_CHECK(positives > 0 && negatives > 0 && scores.size() == positive.size());
  const double high = (positives + 1) / (positives + 2);
  const double low = 1 / (negatives + 2);
  double spread = 0;
  for (const double score : scores) spread = std::max(spread, std::abs(score));
  if (spread == 0) return {.slope = 1, .offset = 0};

  // Scores are scaled to a maximum of 1, so that one damping constant suits all inputs.
  Eigen::Vector2d at(1, 0);
  constexpr int kRounds = 100;
  for (int round = 0; round < kRounds; ++round) {
    constexpr double kDamping = 1e-3;
    Eigen::Vector2d gradient = kDamping * at;
    Eigen::Matrix2d hessian = kDamping * Eigen::Matrix2d::Identity();
    for (std::size_t i = 0; i < scores.size(); ++i) {
      const Eigen::Vector2d x(scores[i] / spread, 1);
      const double probability = 1 / (1 + std::exp(-at.dot(x)));
      const double weight = 0.5 / (positive[i] ? positives : negatives);
      gradient += weight * (probability - (positive[i] ? high : low)) * x;
      hessian += weight * std::max(probability * (1 - probability), 1e-4) * x * x.transpose();
    }
    const Eigen::Vector2d step = hessian.ldlt().solve(gradient);
    at -= step;
    if (step.norm() < 1e-9) break;
  }
  constexpr double kMinSlope = 1e-3;
  return {.slope = std::max(at.x(), kMinSlope) / spread, .offset = at.y()};
}

}  // namespace victorious

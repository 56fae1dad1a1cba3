#include "victorious/category/linear/ridge.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "victorious/base/check.h"

namespace victorious {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

RidgeFit FitRidge(const MatrixXd& kernel, const Eigen::MatrixXi& targets, std::span<const int> group,
                  const VectorXd& penalty) {
  const Index all = kernel.rows();
  VICTORIOUS_CHECK(all == targets.rows() && all == penalty.size() && static_cast<std::size_t>(all) == group.size());
  std::vector<Index> used;
  std::map<int, std::vector<Index>> used_of_group;  // group id to indices into `used`
  for (Index i = 0; i < all; ++i) {
    const bool learned = (targets.row(i).array() != 0).all();
    VICTORIOUS_CHECK(learned || (targets.row(i).array() == 0).all());
    if (!learned) continue;
    used_of_group[group[static_cast<std::size_t>(i)]].push_back(static_cast<Index>(used.size()));
    used.push_back(i);
  }
  MatrixXd system = kernel(used, used);
  system.diagonal() += penalty(used);
  const MatrixXd inverse = system.llt().solve(MatrixXd::Identity(system.rows(), system.cols()));
  const MatrixXd alpha = inverse * targets(used, Eigen::all).cast<double>();

  RidgeFit fit{.alpha = MatrixXd::Zero(all, targets.cols()), .held_out = kernel(Eigen::all, used) * alpha};
  fit.alpha(used, Eigen::all) = alpha;
  std::map<int, std::vector<Index>> all_of_group;
  for (Index i = 0; i < all; ++i) all_of_group[group[static_cast<std::size_t>(i)]].push_back(i);
  for (const auto& [number, members] : used_of_group) {
    // Block-wise leave-one-group-out: alpha_-g = alpha - inverse(:, g) inverse(g, g)^-1 alpha(g).
    const MatrixXd own = MatrixXd(inverse(members, members)).lu().solve(MatrixXd(alpha(members, Eigen::all)));
    const MatrixXd without = alpha - inverse(Eigen::all, members) * own;
    const std::vector<Index>& held_out = all_of_group[number];
    fit.held_out(held_out, Eigen::all) = kernel(held_out, used) * without;
  }
  return fit;
}

double Calibration::Probability(double score) const { return 1 / (1 + std::exp(-(slope * score + offset))); }

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

#include "victorious/category/ridge.h"

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

RidgeFit FitRidge(const MatrixXd& kernel, std::span<const int> target, std::span<const int> group, double lambda) {
  const Index all = kernel.rows();
  VICTORIOUS_CHECK(static_cast<std::size_t>(all) == target.size() && target.size() == group.size());
  std::vector<Index> used;
  for (Index i = 0; i < all; ++i)
    if (target[static_cast<std::size_t>(i)] != 0) used.push_back(i);
  const auto positives = static_cast<double>(std::ranges::count(target, 1));
  const double negatives = static_cast<double>(used.size()) - positives;
  VICTORIOUS_CHECK(positives > 0 && negatives > 0);

  MatrixXd system = kernel(used, used);
  VectorXd y(static_cast<Index>(used.size()));
  for (Index i = 0; i < y.size(); ++i) {
    y(i) = target[static_cast<std::size_t>(used[static_cast<std::size_t>(i)])];
    system(i, i) += lambda * 2 * (y(i) > 0 ? positives : negatives) / static_cast<double>(used.size());
  }
  const MatrixXd inverse = system.ldlt().solve(MatrixXd::Identity(system.rows(), system.cols()));
  const VectorXd alpha = inverse * y;

  RidgeFit fit{.alpha = VectorXd::Zero(all), .held_out = kernel(Eigen::all, used) * alpha};
  std::map<int, std::vector<Index>> used_of_group;  // places in `used`
  for (Index i = 0; i < y.size(); ++i) {
    const Index example = used[static_cast<std::size_t>(i)];
    fit.alpha(example) = alpha(i);
    used_of_group[group[static_cast<std::size_t>(example)]].push_back(i);
  }
  // Without a group, the others' weights are what they are less what the group's weights had them make up for.
  std::map<int, VectorXd> alpha_without;
  for (const auto& [number, members] : used_of_group) {
    const MatrixXd block = inverse(members, members);
    const VectorXd own = alpha(members);
    alpha_without[number] = alpha - inverse(Eigen::all, members) * block.lu().solve(own);
  }
  for (Index i = 0; i < all; ++i) {
    const auto without = alpha_without.find(group[static_cast<std::size_t>(i)]);
    if (without != alpha_without.end()) fit.held_out(i) = kernel(i, used).dot(without->second);
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

  // On scores of size 1, so that one damping fits all.
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
  constexpr double kLeastSlope = 1e-3;
  return {.slope = std::max(at.x(), kLeastSlope) / spread, .offset = at.y()};
}

}  // namespace victorious

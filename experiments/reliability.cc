#include "experiments/reliability.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

namespace victorious {

std::vector<ReliabilityBin> Reliability(std::span<const Judged> judged) {
  std::vector<ReliabilityBin> bins(kReliabilityBins);
  for (const Judged& one : judged) {
    const int at = std::clamp(static_cast<int>(one.score * kReliabilityBins), 0, kReliabilityBins - 1);
    ReliabilityBin& bin = bins[static_cast<std::size_t>(at)];
    ++bin.count;
    bin.mean_score += one.score;
    bin.right += one.right ? 1 : 0;
  }
  for (ReliabilityBin& bin : bins) {
    if (bin.count == 0) continue;
    const auto count = static_cast<double>(bin.count);
    bin.mean_score /= count;
    bin.right /= count;
    bin.standard_error = std::sqrt(bin.right * (1 - bin.right) / count);
  }
  return bins;
}

double CalibrationError(std::span<const Judged> judged) {
  double sum = 0;
  for (const ReliabilityBin& bin : Reliability(judged)) {
    sum += static_cast<double>(bin.count) * std::abs(bin.mean_score - bin.right);
  }
  return judged.empty() ? 0 : sum / static_cast<double>(judged.size());
}

double Logistic::ScoreOf(double evidence) const { return 1 / (1 + std::exp((even - evidence) / scale)); }

Logistic FitLogistic(std::span<const Judged> judged) {
  const auto right = static_cast<double>(std::ranges::count(judged, true, &Judged::right));
  const auto wrong = static_cast<double>(judged.size()) - right;
  constexpr double kSlopePrior = 0.1;                              // of the squared slope; slope per unit of -log10 NFA
  Eigen::Vector2d line(std::log((right + 1) / (wrong + 1)), 0.1);  // log odds = line[0] + line[1] * (-log10 NFA)
  const auto loss = [&](const Eigen::Vector2d& at) {
    double sum = 0.5 * kSlopePrior * at[1] * at[1];
    for (const Judged& one : judged) {
      const double odds = at[0] + at[1] * one.evidence;
      sum += std::max(odds, 0.0) + std::log1p(std::exp(-std::abs(odds))) - (one.right ? odds : 0);
    }
    return sum;
  };
  constexpr int kRounds = 100;
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix2d hessian = 1e-9 * Eigen::Matrix2d::Identity();
    hessian(1, 1) += kSlopePrior;
    Eigen::Vector2d gradient(0, kSlopePrior * line[1]);
    for (const Judged& one : judged) {
      const double share = 1 / (1 + std::exp(-line[0] - line[1] * one.evidence));
      const Eigen::Vector2d input(1, one.evidence);
      gradient += (share - (one.right ? 1 : 0)) * input;
      hessian += share * (1 - share) * input * input.transpose();
    }
    Eigen::Vector2d step = hessian.ldlt().solve(gradient);
    const double before = loss(line);
    while (loss(line - step) > before && step.norm() > 1e-12) step /= 2;
    line -= step;
    if (step.norm() < 1e-9) break;
  }
  constexpr double kLeastSlope = 1e-3;
  const double slope = std::max(kLeastSlope, line[1]);
  return {-line[0] / slope, 1 / slope};
}

std::vector<std::vector<Judged>> ScoredByOthers(const std::vector<std::vector<Judged>>& groups) {
  if (groups.size() == 1) return std::vector<std::vector<Judged>>(1);
  std::vector<std::vector<Judged>> scored = groups;
  for (std::size_t held_out = 0; held_out < groups.size(); ++held_out) {
    std::vector<Judged> others;
    for (std::size_t i = 0; i < groups.size(); ++i) {
      if (i != held_out) others.insert(others.end(), groups[i].begin(), groups[i].end());
    }
    const Logistic curve = FitLogistic(others);
    for (Judged& one : scored[held_out]) one.score = curve.ScoreOf(one.evidence);
  }
  return scored;
}

}  // namespace victorious

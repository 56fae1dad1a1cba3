#include "experiments/reliability.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

namespace victorious {

std::vector<ReliabilityBin> Reliability(std::span<const LabelledDetection> labelled) {
  std::vector<ReliabilityBin> bins(kReliabilityBins);
  for (const LabelledDetection& one : labelled) {
    const int at = std::clamp(static_cast<int>(one.score * kReliabilityBins), 0, kReliabilityBins - 1);
    ReliabilityBin& bin = bins[static_cast<std::size_t>(at)];
    ++bin.count;
    bin.mean_score += one.score;
    bin.correct += one.correct ? 1 : 0;
  }
  for (ReliabilityBin& bin : bins) {
    if (bin.count == 0) continue;
    const auto count = static_cast<double>(bin.count);
    bin.mean_score /= count;
    bin.correct /= count;
    bin.standard_error = std::sqrt(bin.correct * (1 - bin.correct) / count);
  }
  return bins;
}

double CalibrationError(std::span<const LabelledDetection> labelled) {
  double sum = 0;
  for (const ReliabilityBin& bin : Reliability(labelled)) {
    sum += static_cast<double>(bin.count) * std::abs(bin.mean_score - bin.correct);
  }
  return labelled.empty() ? 0 : sum / static_cast<double>(labelled.size());
}

double Logistic::Probability(double neg_log10_nfa) const {
  return 1 / (1 + std::exp((midpoint - neg_log10_nfa) / scale));
}

Logistic FitLogistic(std::span<const LabelledDetection> labelled) {
  const auto correct = static_cast<double>(std::ranges::count(labelled, true, &LabelledDetection::correct));
  const auto wrong = static_cast<double>(labelled.size()) - correct;
  constexpr double kSlopePrior = 0.1;  // of the squared slope; slope per unit of -log10 NFA
  Eigen::Vector2d line(std::log((correct + 1) / (wrong + 1)), 0.1);  // log odds = line[0] + line[1] * (-log10 NFA)
  const auto loss = [&](const Eigen::Vector2d& at) {
    double sum = 0.5 * kSlopePrior * at[1] * at[1];
    for (const LabelledDetection& one : labelled) {
      const double odds = at[0] + at[1] * one.neg_log10_nfa;
      sum += std::max(odds, 0.0) + std::log1p(std::exp(-std::abs(odds))) - (one.correct ? odds : 0);
    }
    return sum;
  };
  constexpr int kRounds = 100;
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix2d hessian = 1e-9 * Eigen::Matrix2d::Identity();
    hessian(1, 1) += kSlopePrior;
    Eigen::Vector2d gradient(0, kSlopePrior * line[1]);
    for (const LabelledDetection& one : labelled) {
      const double share = 1 / (1 + std::exp(-line[0] - line[1] * one.neg_log10_nfa));
      const Eigen::Vector2d input(1, one.neg_log10_nfa);
      gradient += (share - (one.correct ? 1 : 0)) * input;
      hessian += share * (1 - share) * input * input.transpose();
    }
    Eigen::Vector2d step = hessian.ldlt().solve(gradient);
    const double before = loss(line);
    while (loss(line - step) > before && step.norm() > 1e-12) step /= 2;
    line -= step;
    if (step.norm() < 1e-9) break;
  }
  constexpr double kMinSlope = 1e-3;
  const double slope = std::max(kMinSlope, line[1]);
  return {-line[0] / slope, 1 / slope};
}

std::vector<std::vector<LabelledDetection>> CrossValidate(const std::vector<std::vector<LabelledDetection>>& groups) {
  if (groups.size() == 1) return std::vector<std::vector<LabelledDetection>>(1);
  std::vector<std::vector<LabelledDetection>> scored = groups;
  for (std::size_t held_out = 0; held_out < groups.size(); ++held_out) {
    std::vector<LabelledDetection> others;
    for (std::size_t i = 0; i < groups.size(); ++i) {
      if (i != held_out) others.insert(others.end(), groups[i].begin(), groups[i].end());
    }
    const Logistic curve = FitLogistic(others);
    for (LabelledDetection& one : scored[held_out]) one.score = curve.Probability(one.neg_log10_nfa);
  }
  return scored;
}

}  // namespace victorious

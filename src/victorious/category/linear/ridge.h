// Trains the linear classifier: regularised least squares on the targets +1 and -1 in dual form, with held-out scores.
// One factorisation gives the weights of the examples and, in closed form, all held-out scores for the calibration.
// Source: R. Rifkin, G. Yeo, T. Poggio, "Regularized least-squares classification", 2003 (leave-one-out there; here
// leave-one-group-out, because crops of one image are held out together).
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

namespace victorious {

/// Result of FitRidge: one row per example, one column per problem.
struct RidgeFit {
  Eigen::MatrixXd alpha;     ///< dual weights: score(x) = sum_i alpha_i k(x, x_i)
  Eigen::MatrixXd held_out;  ///< score of each example by the fit without its group
};

/// Fits all problems: alpha = (K + diag(penalty))^-1 targets.
/// @param kernel   K, examples x examples, symmetric positive semidefinite, including the constant 1 of the offset
/// @param targets  examples x problems: +1 or -1; an example with a row of zeros is not trained on, but has a held-out
///                 score
/// @param group    group id of each example; examples of one group are held out together
/// @param penalty  per example, positive; a larger penalty lowers the influence of the example
/// @pre a row of `targets` is zero in all columns or in none
/// Cost: one factorisation, independent of the number of problems.
RidgeFit FitRidge(const Eigen::MatrixXd& kernel, const Eigen::MatrixXi& targets, std::span<const int> group,
                  const Eigen::VectorXd& penalty);

/// Maps a score to a probability: 1 / (1 + exp(-(slope score + offset))).
struct Calibration {
  double slope = 1;
  double offset = 0;

  [[nodiscard]] double Probability(double score) const;
};

/// Platt scaling (2000) by Newton's method, with his softened targets. Both classes have equal total weight, so that
/// probability 0.5 lies between them independently of their sizes. The slope is positive even for uninformative scores.
/// @param positive  the class of each score
/// @pre at least one score of each class
Calibration Calibrate(std::span<const double> scores, const std::vector<bool>& positive);

}  // namespace victorious

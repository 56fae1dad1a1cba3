// Trains the linear classifier: regularised least squares on the targets +1 and -1 in dual form, with held-out scores.
// One factorisation gives the weights of the examples and, in closed form, all held-out scores for the calibration.
// Source: R. Rifkin, G. Yeo, T. Poggio, "Regularized least-squares classification", 2003 (leave-one-out there; here
// leave-one-group-out, because crops of one image are held out together).
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

namespace victorious {

/// (K + diag(penalty))^-1, by Cholesky. Its product with targets gives the dual weights of their fit.
/// @param kernel   K, symmetric positive semidefinite
/// @param penalty  positive
Eigen::MatrixXd RegularisedInverse(Eigen::MatrixXd kernel, const Eigen::VectorXd& penalty);

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

}  // namespace victorious

// The linear classifier's training: regularised least squares on +1 and -1, in its dual form, and what it says of each
// example that it has not seen. One factorisation gives the weights of the examples and, in closed form, every held-out
// score, which calibration needs.
// Source: R. Rifkin, G. Yeo, T. Poggio, "Regularized least-squares classification", 2003 (held-out scores there for one
// example at a time, here for groups: crops of one picture are held out together).
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

namespace victorious {

/// A row an example, a column a problem.
struct RidgeFit {
  Eigen::MatrixXd alpha;     ///< the score of x is sum over i of alpha_i k(x, x_i)
  Eigen::MatrixXd held_out;  ///< of each example, the score without its group
};

/// @param kernel  symmetric, positive semidefinite; with whatever stands for the offset (a constant 1) added
/// @param targets  a row an example, a column a problem: +1 or -1; rows of 0: not learned from, but scored without
///                 their groups like the others
/// @param group    examples with equal numbers are held out together
/// @param penalty  one an example, above 0: the larger, the less it counts
/// @pre a row is of 0 as a whole or not at all
/// Cost: one factorisation, whatever the number of problems.
RidgeFit FitRidge(const Eigen::MatrixXd& kernel, const Eigen::MatrixXi& targets, std::span<const int> group,
                  const Eigen::VectorXd& penalty);

/// A score to a probability: 1 / (1 + exp(-(slope score + offset))).
struct Calibration {
  double slope = 1;
  double offset = 0;

  [[nodiscard]] double Probability(double score) const;
};

/// Platt's fit (2000) by Newton's method, with his softened targets; both classes count alike as a whole, so that 0.5
/// lies between them whatever their numbers. The slope is above 0 even where the scores say nothing.
/// @param positive  one a score; of both kinds at least one
Calibration Calibrate(std::span<const double> scores, const std::vector<bool>& positive);

}  // namespace victorious

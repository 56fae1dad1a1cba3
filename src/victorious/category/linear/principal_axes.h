// Principal component analysis of the columns of a matrix.
#pragma once

#include <Eigen/Core>

namespace victorious {

struct PrincipalAxes {
  Eigen::VectorXf mean;      ///< of the columns
  Eigen::MatrixXd axes;      ///< unit vectors, one per column, by increasing variance
  Eigen::VectorXd variance;  ///< along each axis

  /// The `count` axes of the largest variance, one per row, by increasing variance.
  [[nodiscard]] Eigen::MatrixXd Largest(Eigen::Index count) const { return axes.rightCols(count).transpose(); }
};

/// @param columns  one sample per column, at least one
/// The covariance is accumulated in single precision, and decomposed in double precision.
PrincipalAxes FitPrincipalAxes(const Eigen::MatrixXf& columns);

}  // namespace victorious

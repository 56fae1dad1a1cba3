#include "victorious/category/linear/principal_axes.h"

#include <Eigen/Eigenvalues>

namespace victorious {

PrincipalAxes FitPrincipalAxes(const Eigen::MatrixXf& columns) {
  const Eigen::VectorXf mean = columns.rowwise().mean();
  const Eigen::MatrixXf centred = columns.colwise() - mean;
  const Eigen::MatrixXd covariance =
      (centred * centred.transpose()).cast<double>() / static_cast<double>(columns.cols());
  // Eigen orders eigenvalues increasingly.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(covariance);
  return {.mean = mean, .axes = solver.eigenvectors(), .variance = solver.eigenvalues()};
}

}  // namespace victorious

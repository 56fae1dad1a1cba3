// Symmetric matrices scaled to a unit diagonal, before they are factorised: a covariance becomes the correlation
// matrix, so that unknowns of different units (metres, radians) are comparable and the limit below which a matrix is
// singular does not depend on them.
#pragma once

#include <optional>

#include <Eigen/Core>

namespace victorious {

template <typename Matrix>
struct UnitDiagonal {
  Eigen::Matrix<double, Matrix::RowsAtCompileTime, 1, 0, Matrix::MaxRowsAtCompileTime, 1> scale;
  Matrix matrix;  ///< diag(scale) * original * diag(scale)
};

/// Returns the scaled matrix; std::nullopt if an entry is not finite, or an entry of the diagonal not above 0.
template <typename Matrix>
std::optional<UnitDiagonal<Matrix>> ScaleToUnitDiagonal(const Matrix& symmetric) {
  if (!symmetric.allFinite() || !(symmetric.diagonal().minCoeff() > 0)) return std::nullopt;
  UnitDiagonal<Matrix> scaled;
  scaled.scale = symmetric.diagonal().cwiseSqrt().cwiseInverse();
  if (!scaled.scale.allFinite()) return std::nullopt;
  scaled.matrix = scaled.scale.asDiagonal() * symmetric * scaled.scale.asDiagonal();
  if (!scaled.matrix.allFinite()) return std::nullopt;
  return scaled;
}

}  // namespace victorious

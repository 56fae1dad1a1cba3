// Guarded operations on 6 x 6 covariance and information matrices: inverse and Mahalanobis distance.
#pragma once

#include <optional>

#include "victorious/place/navigate/landmark.h"

namespace victorious {

/// The inverse; std::nullopt if the matrix is not a covariance: a variance that is 0, negative or not finite, or a
/// correlation matrix that is not positive definite. Correlations numerically equal to 1 are slightly reduced.
std::optional<Matrix6> InvertCovariance(const Matrix6& covariance);

/// The covariance of a sighting from its information matrix, regularised: components without information get a variance
/// of pi^2 rad^2 (rotation) or 1e8 m^2 (translation). A matrix that is not an information matrix (not finite, or not
/// positive semidefinite) is taken as no information: the result is those variances.
Matrix6 CovarianceFromInformation(const Matrix6& information);

/// The squared Mahalanobis distance; infinity if the matrix is not a covariance.
double SquaredMahalanobis(const Vector6& off, const Matrix6& covariance);

}  // namespace victorious

// What a covariance of six numbers, or an information matrix, is asked for: its inverse, and lengths in its sigmas.
#pragma once

#include <optional>

#include "victorious/navigate/landmark.h"

namespace victorious {

/// Nothing where it is no covariance: a variance that is 0, negative or not finite, or correlations that cannot be.
/// Correlations that cannot be told from 1 are taken as a little less.
std::optional<Matrix6> InverseOf(const Matrix6& covariance);

/// Of a sighting: what its information leaves open may be anything.
Matrix6 CovarianceOf(const Matrix6& information);

/// Squared length in sigmas; infinity, which is near nothing, where it is no covariance.
double SquaredSigmas(const Vector6& off, const Matrix6& covariance);

}  // namespace victorious

// Scalar accuracy measures of a position covariance: CE90 and LE90.
#pragma once

#include <Eigen/Core>

#include "victorious/types/geolocation.h"

namespace victorious {

/// The radius of the circle about the mean that contains the given probability (in (0, 1)) of a bivariate normal
/// distribution with this covariance, for example 0.9 for CE90. Computed by numerical integration, so it is exact for
/// any aspect ratio of the error ellipse, unlike the usual closed-form approximations. Same unit of length as the
/// covariance.
double CircularError(const Eigen::Matrix2d& covariance, double probability);

/// LE90: half the width of the interval about the mean that contains 90 % of a normal distribution with this variance.
double LinearError90(double variance);

/// Sets CE90 and LE90 of a place by its covariance.
void SetErrorRadii(Geolocation& place);

}  // namespace victorious

// What a covariance says in one number: CE90 and LE90.
#pragma once

#include <Eigen/Core>

namespace victorious {

/// The radius of the circle about the mean that holds `share` (in (0, 1)) of a normal distribution with this
/// covariance: exact for every shape of the ellipse, unlike the usual formulas. In the covariance's unit of length.
double CircularError(const Eigen::Matrix2d& covariance, double share);

/// Half the interval about the mean that holds 90 % of a normal distribution.
double LinearError90(double variance);

}  // namespace victorious

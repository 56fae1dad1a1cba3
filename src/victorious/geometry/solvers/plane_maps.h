// Weighted least squares for the affine map (3 or more pairs) and the homography (4 or more) of the plane.
// Affine: linear in its 6 numbers. Homography: the normalised direct linear transform (Hartley and Zisserman, Multiple
// View Geometry, algorithm 4.2), each pair's two rows weighted.
#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "victorious/geometry/solvers/similarity.h"

namespace victorious {

/// target_from_source as a 3x3 matrix with the last row (0, 0, 1).
/// @return nothing if the sources lie on one line
std::optional<Eigen::Matrix3d> SolveAffine(std::span<const PointPair> pairs, std::span<const double> weights = {});

/// target_from_source, scaled so that its last element is 1.
/// @return nothing for a degenerate configuration (fewer than 4 points in general position)
std::optional<Eigen::Matrix3d> SolveHomography(std::span<const PointPair> pairs, std::span<const double> weights = {});

}  // namespace victorious

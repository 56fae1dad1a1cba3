// Weighted least squares for affine maps (3 or more pairs) and homographies (4 or more pairs) of the plane. Affine:
// linear in its 6 parameters. Homography: the normalised direct linear transform (Hartley and Zisserman, Multiple View
// Geometry, algorithm 4.2), with both rows of a pair weighted.
#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "victorious/geometry/solvers/similarity.h"

namespace victorious {

/// target_from_source as a 3x3 matrix with the last row (0, 0, 1).
/// @return std::nullopt if the source points are collinear
std::optional<Eigen::Matrix3d> SolveAffine(std::span<const PointPair> pairs, std::span<const double> weights = {});

/// target_from_source, scaled so that its last element is 1.
/// @return std::nullopt for a degenerate configuration (fewer than 4 points in general position)
std::optional<Eigen::Matrix3d> SolveHomography(std::span<const PointPair> pairs, std::span<const double> weights = {});

}  // namespace victorious

// pose/, after MLESAC: model selection between similarity (4 parameters), affine map (6) and homography (8).
// Method: EM with an annealed inlier deviation for each kind; selection by the Bayesian information criterion,
//   log likelihood - 0.5 parameters ln(2 pairs)   (Schwarz 1978).
#pragma once

#include <span>

#include <Eigen/Core>

#include "victorious/geometry/polygon.h"
#include "victorious/geometry/solvers/similarity.h"

namespace victorious {

/// Fits each kind of map by expectation maximisation while the standard deviation falls from `start_sigma_px` to
/// `noise_px`. Rejects maps under which the outline changes its orientation, its convexity or its area by more than a
/// factor of three.
/// @param pairs           template to scene, px; the inliers of `start`
/// @param scene_area_px2  area of the uniform outlier distribution
/// @return scene_from_template, 3x3; the matrix of `start` if no fit is accepted
Eigen::Matrix3d RefinePlane(std::span<const PointPair> pairs, const Similarity2& start, double start_sigma_px,
                            double noise_px, double scene_area_px2, const Polygon& outline);

}  // namespace victorious

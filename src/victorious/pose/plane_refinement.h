// From a similarity to the plane map that the matches support: similarity, affine map or homography, whichever explains
// them best for the numbers it needs.
#pragma once

#include <span>

#include <Eigen/Core>

#include "victorious/geometry/polygon.h"
#include "victorious/geometry/solvers/similarity.h"

namespace victorious {

/// Fits each kind of map by expectation maximisation, the deviation narrowing from `start_sigma_px` to `noise_px`, and
/// takes the one of the best Bayesian information criterion (Schwarz 1978) under which the outline keeps its sense, its
/// convexity and roughly its area.
/// @param pairs  template to scene, px
/// @return scene_from_template, 3x3
Eigen::Matrix3d RefinePlane(std::span<const PointPair> pairs, const Similarity2& start, double start_sigma_px,
                            double noise_px, double scene_area_px2, const Polygon& outline);

}  // namespace victorious

// Calibrates one node from held-out scores: scores of examples by models that were trained without them.
#pragma once

#include <span>

#include <Eigen/Core>

#include "victorious/category/common/category_node.h"

namespace victorious {

/// Fits the score-to-probability map of a node to held-out scores.
/// @param targets  per example: +1, -1, or 0 for examples that are ignored
/// @param scores   per example: the score by a model that was trained without the example's image
/// Only examples with used_for_calibration enter. A negative image enters once, with the maximum score of its examples:
/// with more windows per image, the maximum over negative windows rises by chance. If the examples are all positive or
/// all negative, the probability is constant, 2e-9 from 1 or 0.
Calibration CalibrateHeldOut(std::span<const CategoryExample> examples, std::span<const int> targets,
                             const Eigen::VectorXd& scores);

}  // namespace victorious

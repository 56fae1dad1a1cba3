// From the scores of examples that a model has not seen to the calibration of one node.
#pragma once

#include <span>

#include "victorious/category/category_model.h"

namespace victorious {

/// @param targets  +1, -1, or 0 for examples left out
/// @param scores   one an example, each from a model that has not seen its picture
/// Of a picture that does not show the node the highest score counts, whatever the number of its examples: where more
/// windows are looked at, one of them comes near the node by chance. A node that all examples that calibrate show, or
/// none, is certain.
Calibration CalibrateOn(std::span<const CategoryExample> examples, std::span<const int> targets,
                        const Eigen::VectorXd& scores);

}  // namespace victorious

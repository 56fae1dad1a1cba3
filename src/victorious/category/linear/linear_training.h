// Fits the linear classifier: regularised least squares in the dual (ridge.h) on the sum of the kernels of words,
// phrases, Fisher vectors and shapes, and its calibration by held-out scores of the training images.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "victorious/category/common/category_node.h"
#include "victorious/category/common/vocabulary.h"
#include "victorious/category/linear/linear_model.h"

namespace victorious {

/// Penalty of the weights, in units of the kernel of words, of which an image with itself has the value 2 (1 of the
/// histogram, 1 of the offset). A larger penalty gives smoother weights.
inline constexpr double kRidgePenalty = 0.1;

struct LinearFit {
  LinearModel model;
  std::vector<CategoryNode> nodes;  ///< with their calibrations
};

/// @param examples    at least one with features
/// @param nodes       their calibrations are ignored
/// @param vocabulary  learned from the examples
/// @param words       the options that it was learned with
LinearFit TrainLinear(std::span<const CategoryExample> examples, std::vector<CategoryNode> nodes,
                      const Vocabulary& vocabulary, const VocabularyOptions& words, const LinearOptions& options,
                      std::uint64_t seed);

}  // namespace victorious

// Updates a model from user feedback (results marked right or wrong), within seconds and without the training images.
// Method: regularised least squares on the change of the weights: the smallest change for which each marked image
// reaches its target score of +1 or -1. A mark whose margin is already at least 1 has no effect. The training data
// enter only through the current weights: enough contradicting marks override them.
#pragma once

#include <cstddef>
#include <span>

#include "victorious/category/category_model.h"

namespace victorious {

/// User feedback on one image: `right` if it shows `category`.
struct CategoryFeedback {
  std::string category;
  bool right = true;
  FeatureSet features;
};

/// Returns the model with the weights of both methods fitted to the marks; calibrations are unchanged.
/// Errors: kInvalidArgument for a category that the model does not have; kUnsupported for scoring "likelihood", which
/// has no weights, and for models with shapes, whose weights belong to training examples: these need retraining.
[[nodiscard]] Expected<CategoryModel> RefineCategories(CategoryModel model, std::span<const CategoryFeedback> marks);

/// The number of marks that agree with a model: right with a probability of one half or more, wrong with less. A mark
/// of a category that the model does not have agrees if it is wrong.
[[nodiscard]] std::size_t CountAgreeing(const CategoryModel& model, std::span<const CategoryFeedback> marks);

}  // namespace victorious

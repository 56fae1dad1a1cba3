// Feedback: a model made better by results that a user marked right or wrong, in seconds and without the pictures that
// it was trained on.
// Method: regularised least squares about the weights that there are: the smallest change that gives each marked
// picture its due. A mark that the model agrees with by a clear margin changes nothing. What training showed is kept
// only in the weights: marks that contradict it win where there are enough of them.
#pragma once

#include <span>

#include "victorious/category/category_model.h"

namespace victorious {

/// A picture that a user looked at: it shows `category`, or it does not.
struct CategoryMark {
  std::string category;
  bool right = true;
  FeatureSet features;
};

/// The model's weights, both methods', changed to fit the marks; calibrations stay.
/// Errors: kInvalidArgument for a category that the model does not have; kUnsupported for scoring "likelihood", which
/// has no weights, and for shapes, whose weights are those of examples: train again.
Expected<CategoryModel> RefineCategories(CategoryModel model, std::span<const CategoryMark> marks);

}  // namespace victorious

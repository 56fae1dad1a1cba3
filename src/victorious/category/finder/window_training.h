// Trains a category model for sliding windows (category/windows.h). Positive windows contain an object, jittered in
// position and scale as in a search; negative windows come from random positions of background images.
// Method: a first model is trained on these windows; its false positives in the background images and beside the
// objects are added as hard negatives, and the model is trained again (N. Dalal and B. Triggs, "Histograms of oriented
// gradients for human detection", CVPR 2005). Probabilities are calibrated with the maximum score of each background
// image, which accounts for the number of windows searched (category/common/held_out.h).
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"
#include "victorious/base/options.h"
#include "victorious/category/category_model.h"
#include "victorious/geometry/box.h"

namespace victorious {

class CategoryFeaturizer;
struct CategoryTrainOptions;

/// Numbers of training windows per image.
struct WindowTrainOptions {
  int copies = 2;
  int background = 10;
  int hard_negatives = 4;

  void ListFields(FieldList& fields);
};

/// A labelled image to sample windows from.
struct LabelledImage {
  std::string category;
  cv::Mat grey;            ///< CV_8UC1
  std::optional<Box> box;  ///< of the object, px; nullopt: a background image without any object
};

/// Errors: those of TrainCategories; kInvalidArgument for options out of range, without background images, and if more
/// than one category has no boxes.
/// Cost: training twice, and one sliding-window search of every image.
[[nodiscard]] Expected<CategoryModel> TrainOnWindows(const CategoryFeaturizer& featurizer,
                                                     std::span<const LabelledImage> images,
                                                     const CategoryTrainOptions& options);

}  // namespace victorious

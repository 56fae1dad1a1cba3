// Categories for windows (category/windows.h): what is learned from is cut out of pictures as windows will be, the
// things about the middle, not quite, and of what is none of them windows from anywhere.
// Method: a first model of random windows looks through the pictures of none of them; what it takes for a thing there
// is learned from, too (hard negatives: N. Dalal and B. Triggs, "Histograms of oriented gradients for human detection",
// CVPR 2005). Scores become probabilities by the highest score of each such picture: where many windows are looked at,
// a find must be the clearer (category/held_out.h).
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

class CategoryEye;
struct CategoryTrainOptions;

/// What windows are cut out of pictures to learn from.
struct WindowTrainOptions {
  int copies = 2;
  int background = 10;
  int mined = 4;

  void ListFields(FieldList& fields);
};

/// A picture to cut windows out of.
struct BoxedPicture {
  std::string category;
  cv::Mat grey;            ///< CV_8UC1
  std::optional<Box> box;  ///< of the thing, px; nothing: none of the things is anywhere in the picture
};

/// Errors: those of TrainCategories; kInvalidArgument for options out of range, and without a picture of none of them.
/// Cost: that of training twice, and of looking through every picture once.
Expected<CategoryModel> TrainOnWindows(const CategoryEye& eye, std::span<const BoxedPicture> pictures,
                                       const CategoryTrainOptions& options);

}  // namespace victorious

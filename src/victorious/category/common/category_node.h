// Categories, their hierarchy and their training examples.
//
// Categories may form a hierarchy: an image of "vehicle/car/sedan" is also an image of "vehicle/car" and of "vehicle".
// Every node that is named in training, and each of its ancestors, has its own score.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "victorious/base/enum_text.h"
#include "victorious/category/common/calibration.h"
#include "victorious/types/feature_set.h"

namespace victorious {

/// Features that enter the score: visual words and phrases, or visual words only (the baseline).
enum class CategoryMethod { kPhrases, kWords };

inline constexpr auto kCategoryMethodTexts =
    std::to_array<EnumText<CategoryMethod>>({{CategoryMethod::kPhrases, "phrases"}, {CategoryMethod::kWords, "words"}});

/// A node of the hierarchy.
struct CategoryNode {
  std::string name;           ///< full path: "vehicle/car"
  bool can_be_label = false;  ///< true if training images carry this name: only such nodes can be a label
  Calibration phrases;        ///< for CategoryMethod::kPhrases
  Calibration words;          ///< for CategoryMethod::kWords

  [[nodiscard]] const Calibration& CalibrationFor(CategoryMethod method) const {
    return method == CategoryMethod::kPhrases ? phrases : words;
  }
};

/// A training example: an image or a crop of one.
struct CategoryExample {
  std::string category;
  FeatureSet features;
  int image = 0;                     ///< image id: equal for all examples that come from one image
  bool used_for_training = true;     ///< true if the classifier is trained on it
  bool used_for_calibration = true;  ///< true if its held-out score is used for calibration; set it for examples that
                                     ///< resemble the images to be classified
  bool mirrored = false;  ///< true for a mirrored copy of another example of the image; excluded from training if
                          ///< it increases the confusion of two categories (the linear classifier)
};

/// Returns true if `ancestor` equals `name` or is one of its ancestors: "vehicle" for "vehicle/car", not for
/// "vehicles".
bool IsWithin(std::string_view name, std::string_view ancestor);

/// Training target of an image of `category` for `node`: +1 positive, -1 negative, 0 unknown (`category` is a proper
/// ancestor of `node`).
int TrainingTarget(std::string_view category, std::string_view node);

/// The features of the examples that are used for training.
std::vector<const FeatureSet*> TrainingFeatures(std::span<const CategoryExample> examples);

}  // namespace victorious

// Image classification by category: the trained model, and the functions TrainCategories and Classify.
//
// Two classifiers share the features and the vocabulary (common/): the shipped one (linear/) and that of the thesis
// (thesis/). The label of an image is the most probable node among those that are named in training. A background
// category ("none of these") is an ordinary category with its own training images.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/category/category_options.h"
#include "victorious/category/common/category_node.h"
#include "victorious/category/common/quantised_image.h"
#include "victorious/category/common/vocabulary.h"
#include "victorious/category/linear/linear_model.h"
#include "victorious/category/thesis/thesis_model.h"
#include "victorious/types/feature_set.h"

namespace victorious {

/// What the training of sliding windows measured.
struct WindowTraining {
  std::string background_category;    ///< of windows without an object: the category of the images without boxes
  double windows_per_background = 0;  ///< mean number of windows of an image without boxes. The probabilities are
                                      ///< calibrated for the best of so many windows. 0: not measured, no correction
};

/// A trained model.
struct CategoryModel {
  std::string program_version;  ///< version of the program that trained the model
  std::string features_json;    ///< options of the feature extraction, as JSON; not interpreted in this folder
  CategoryOptions options;
  std::optional<WindowTraining> windows;  ///< of a model of sliding windows (windows.h)
  Vocabulary vocabulary;
  std::vector<CategoryNode> nodes;                    ///< sorted by name, so that ancestors precede their descendants
  std::variant<LinearModel, ThesisModel> classifier;  ///< by options.scoring

  /// The shipped classifier, or nullptr for a model by the thesis's method.
  [[nodiscard]] const LinearModel* linear() const { return std::get_if<LinearModel>(&classifier); }
};

/// Trains a model. Deterministic for a given options.seed.
/// Errors: kInvalidArgument for fewer than two categories, a category with fewer than two images or without features,
/// a category name that is empty or has empty components, and options out of range.
[[nodiscard]] Expected<CategoryModel> TrainCategories(std::span<const CategoryExample> examples,
                                                      const CategoryOptions& options);

/// Score of one node for one image.
struct CategoryScore {
  double raw = 0;          ///< uncalibrated; comparable between images
  double probability = 0;  ///< calibrated
};

struct CategoryResult {
  std::vector<CategoryScore> scores;  ///< one per node
  std::size_t label = 0;              ///< index of the most probable node with can_be_label
};

/// Scores an image on all nodes and selects its label.
/// @param image  made by QuantiseFeatures with this model
CategoryResult Classify(const CategoryModel& model, const QuantisedImage& image, CategoryMethod method);

/// Quantises an image's features with the model's vocabulary, and computes its Fisher vector and its shape vector if
/// the model has these encoders.
QuantisedImage QuantiseFeatures(const CategoryModel& model, const FeatureSet& features);

}  // namespace victorious

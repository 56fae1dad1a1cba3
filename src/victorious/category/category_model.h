// Image classification by category: the trained model, and the functions TrainCategories and Classify.
//
// Categories may form a hierarchy: an image of "vehicle/car/sedan" is also an image of "vehicle/car" and of "vehicle".
// Every node that is named in training, and each of its ancestors, has its own score. The label of an image is the most
// probable node among those that are named in training. A background category ("none of these") is an ordinary
// category with its own training images.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "victorious/base/error.h"
#include "victorious/category/category_options.h"
#include "victorious/category/common/quantised_image.h"
#include "victorious/category/linear/ridge.h"
#include "victorious/geometry/box.h"
#include "victorious/types/feature_set.h"

namespace victorious {

/// Features that enter the score: visual words and phrases, or visual words only (the baseline).
enum class CategoryMethod { kPhrases, kWords };

/// A node of the hierarchy.
struct CategoryNode {
  std::string name;           ///< full path: "vehicle/car"
  bool can_be_label = false;  ///< true if training images carry this name: only such nodes can be a label
  Calibration phrases;        ///< for CategoryMethod::kPhrases
  Calibration words;          ///< for CategoryMethod::kWords
};

/// Weights of one node in the linear classifier:
///   score = words . h_w + phrases . h_p + fisher . f + shapes . s + offset
/// where h_w and h_p are the histograms of histogram.h, f is the Fisher vector of fisher.h, and s holds the shape
/// kernel values with each of CategoryModel::shape_examples (shape.h).
struct LinearWeights {
  Eigen::VectorXf words;
  Eigen::VectorXf phrases;  ///< empty for CategoryMethod::kWords
  Eigen::VectorXf fisher;   ///< empty for CategoryMethod::kWords
  Eigen::VectorXf shapes;   ///< one weight per column of CategoryModel::shape_examples
  float offset = 0;
};

/// A trained model.
struct CategoryModel {
  std::string program_version;  ///< version of the program that trained the model
  std::string features_json;    ///< options of the feature extraction, as JSON; not interpreted in this folder
  CategoryOptions options;
  Vocabulary vocabulary;
  std::vector<CategoryNode> nodes;  ///< sorted by name, so that ancestors precede their descendants

  // Scoring "linear" only; otherwise empty.
  std::vector<std::uint16_t> cluster_of_word;  ///< cluster index of each word, below word_clusters
  std::size_t word_clusters = 0;               ///< number of word clusters
  FisherEncoder fisher;
  ShapeEncoder shape;
  Eigen::MatrixXf shape_examples;             ///< one column per training example; empty without a shape encoder
  std::vector<LinearWeights> phrase_weights;  ///< one per node, for CategoryMethod::kPhrases
  std::vector<LinearWeights> word_weights;    ///< one per node, for CategoryMethod::kWords

  // Scoring "likelihood" only; otherwise empty.
  std::vector<std::uint32_t> topic_nodes;  ///< node index of each topic
  TopicModel topics;
  std::vector<PhraseGrammar> grammars;  ///< one per topic
};

/// A training example: an image or a crop of one.
struct CategoryExample {
  std::string category;
  FeatureSet features;
  int picture = 0;                   ///< image id: equal for all examples that come from one image
  bool used_for_training = true;     ///< true if the classifier is trained on it
  bool used_for_calibration = true;  ///< true if its held-out score is used for calibration; set it for examples that
                                     ///< resemble the images to be classified
  bool mirrored = false;  ///< true for a mirrored copy of another example of the image; excluded from training if
                          ///< it increases the confusion of two categories (scoring "linear")
};

/// Trains a model. Deterministic for a given options.seed.
/// Errors: kInvalidArgument for fewer than two categories, a category with fewer than two images or without features,
/// a category name that is empty or has empty components, and options out of range.
Expected<CategoryModel> TrainCategories(std::span<const CategoryExample> examples, const CategoryOptions& options);

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
/// @param picture  made by QuantiseFeatures with this model
CategoryResult Classify(const CategoryModel& model, const QuantisedImage& picture, CategoryMethod method);

/// Quantises an image's features with the model's vocabulary, and computes its Fisher vector and its shape vector if
/// the model has these encoders.
QuantisedImage QuantiseFeatures(const CategoryModel& model, const FeatureSet& features);

/// Returns true if `ancestor` equals `name` or is one of its ancestors: "vehicle" for "vehicle/car", not for
/// "vehicles".
bool IsWithin(std::string_view name, std::string_view ancestor);

/// Training target of an image of `category` for `node`: +1 positive, -1 negative, 0 unknown (`category` is a proper
/// ancestor of `node`).
int TrainingTarget(std::string_view category, std::string_view node);

}  // namespace victorious

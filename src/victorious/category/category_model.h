// What training learns and classification needs, and the two verbs between them.
//
// Categories may stand in a hierarchy: "vehicle/car/sedan" is a sedan, which is a car, which is a vehicle. Every node
// that training pictures name, and all its ancestors, has a score of its own; a picture's label is the likeliest of the
// nodes that pictures were named by. A category for "none of these" is one like the others: give it pictures.
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
#include "victorious/category/ridge.h"
#include "victorious/category/worded_picture.h"
#include "victorious/geometry/box.h"
#include "victorious/types/feature_set.h"

namespace victorious {

/// How a picture is scored: by words and phrases, or by words alone (the baseline).
enum class CategoryMethod { kPhrases, kWords };

/// A node of the hierarchy.
struct CategoryNode {
  std::string name;     ///< with its ancestors' names: "vehicle/car"
  bool labels = false;  ///< whether pictures were named by it: such nodes can be a picture's label
  Calibration phrases;  ///< of CategoryMethod::kPhrases
  Calibration words;    ///< of CategoryMethod::kWords
};

/// One node's weights in the linear classifier. The score is words . h_w + phrases . h_p + fisher . f + offset, with
/// the histograms of histogram.h and the vector of fisher.h, + shapes . how like it is to each of shape_examples
/// (shape.h).
struct LinearWeights {
  Eigen::VectorXf words;
  Eigen::VectorXf phrases;  ///< empty for CategoryMethod::kWords
  Eigen::VectorXf fisher;   ///< the same
  Eigen::VectorXf shapes;   ///< one an example of CategoryModel::shape_examples
  float offset = 0;
};

struct CategoryModel {
  std::string program_version;  ///< that made it
  std::string features_json;    ///< the options of whoever makes its features; opaque here
  CategoryOptions options;
  Vocabulary vocabulary;
  std::vector<CategoryNode> nodes;  ///< sorted by name, so that ancestors stand before their descendants

  // Of scoring "linear"; else empty.
  std::vector<std::uint16_t> part_of_word;
  std::size_t parts = 0;
  FisherEncoder fisher;
  ShapeEncoder shape;
  Eigen::MatrixXf shape_examples;             ///< a column an example that was learned from; of a shape encoder alone
  std::vector<LinearWeights> phrase_weights;  ///< one a node
  std::vector<LinearWeights> word_weights;    ///< one a node

  // Of scoring "likelihood"; else empty.
  std::vector<std::uint32_t> topic_nodes;  ///< a topic's node
  TopicModel topics;
  std::vector<PhraseGrammar> grammars;  ///< one a topic
};

/// A picture, or a part of one, to learn from.
struct CategoryExample {
  std::string category;
  FeatureSet features;
  int picture = 0;         ///< examples of one picture have one number
  bool learns = true;      ///< whether categories are learned from it
  bool calibrates = true;  ///< whether its score, by a model that has not seen the picture, helps to calibrate: for
                           ///< what is like the pictures that will be classified
  bool mirrored = false;   ///< a mirror image of another example of the picture: not learned from where it would make
                           ///< two categories be taken for each other (scoring "linear")
};

/// Errors: kInvalidArgument for fewer than two categories to learn, a category of fewer than two pictures or without
/// features,
/// a category's name that is empty or has empty parts, options out of range.
Expected<CategoryModel> TrainCategories(std::span<const CategoryExample> examples, const CategoryOptions& options);

/// One node's score of a picture.
struct CategoryScore {
  double raw = 0;          ///< before calibration: comparable between pictures
  double probability = 0;  ///< calibrated
};

struct CategoryResult {
  std::vector<CategoryScore> scores;  ///< one a node
  std::size_t label = 0;              ///< the node
};

CategoryResult Classify(const CategoryModel& model, const WordedPicture& picture, CategoryMethod method);

/// The picture as the model's words, with its Fisher vector and its shape where the model has them.
WordedPicture WordsOf(const CategoryModel& model, const FeatureSet& features);

/// Whether `ancestor` is `name` or above it: "vehicle" of "vehicle/car", not of "vehicles".
bool IsWithin(std::string_view name, std::string_view ancestor);

/// What a picture of `category` says of `node`: +1: it shows it; -1: it does not; 0: it may, being named more
/// generally.
int TargetOf(std::string_view category, std::string_view node);

}  // namespace victorious

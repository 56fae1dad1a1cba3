// The shipped classifier: linear in the histograms of words and phrases and in the Fisher vector, and in the exemplar
// kernel of shapes. linear_training.h fits it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "victorious/base/options.h"
#include "victorious/category/common/category_node.h"
#include "victorious/category/common/quantised_image.h"
#include "victorious/category/common/vocabulary.h"
#include "victorious/category/common/word_histogram.h"
#include "victorious/category/linear/fisher.h"
#include "victorious/category/linear/phrase_histogram.h"
#include "victorious/category/linear/shape.h"

namespace victorious {

struct LinearOptions {
  PhraseOptions phrases;
  FisherOptions fisher;
  ShapeOptions shapes;

  void ListFields(FieldList& fields);
};

/// Weights of one node in the linear classifier:
///   score = words . h_w + phrases . h_p + fisher . f + shapes . s + offset
/// where h_w and h_p are the histograms of words and phrases, f is the Fisher vector, and s holds the values of the
/// shape kernel with each of LinearModel::shape_examples.
struct LinearWeights {
  Eigen::VectorXf words;
  Eigen::VectorXf phrases;  ///< empty for CategoryMethod::kWords
  Eigen::VectorXf fisher;   ///< empty for CategoryMethod::kWords
  Eigen::VectorXf shapes;   ///< one weight per column of LinearModel::shape_examples
  float offset = 0;
};

struct LinearModel {
  std::vector<std::uint16_t> cluster_of_word;  ///< cluster index of each word, below word_clusters
  std::size_t word_clusters = 0;               ///< number of word clusters
  FisherEncoder fisher;
  ShapeEncoder shape;
  Eigen::MatrixXf shape_examples;             ///< one column per training example; empty without a shape encoder
  std::vector<LinearWeights> phrase_weights;  ///< one per node, for CategoryMethod::kPhrases
  std::vector<LinearWeights> word_weights;    ///< one per node, for CategoryMethod::kWords
};

/// Quantises an image's features, and computes its Fisher vector and its shape if the model has these encoders.
QuantisedImage QuantiseForLinear(const LinearModel& model, const FeatureSet& features, const Vocabulary& vocabulary,
                                 int words_per_keypoint);

/// Input vectors of the linear classifier for one image: h_w, h_p, f and s above.
struct LinearInput {
  SparseVector words;
  SparseVector phrases;    ///< empty for CategoryMethod::kWords
  Eigen::VectorXf fisher;  ///< empty for CategoryMethod::kWords
  Eigen::VectorXf shapes;  ///< empty without a shape encoder
};

/// @param image  quantised with the model's vocabulary, and encoded by its encoders
LinearInput ComputeLinearInput(const LinearModel& model, const QuantisedImage& image, CategoryMethod method);

/// Raw score of one node.
/// @param input  of the same method as the weights; phrases and Fisher vector are ignored by weights for words
double LinearScore(const LinearWeights& weights, const LinearInput& input);

/// Raw score of each node.
std::vector<double> LinearScores(const LinearModel& model, const QuantisedImage& image, CategoryMethod method);

}  // namespace victorious

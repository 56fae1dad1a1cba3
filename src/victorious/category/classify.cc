#include <algorithm>

#include "victorious/base/check.h"
#include "victorious/category/category_model.h"
#include "victorious/category/thesis/likelihood.h"

namespace victorious {
namespace {

double DotWith(const Eigen::VectorXf& weights, const SparseVector& histogram) {
  double sum = 0;
  for (const auto& [index, value] : histogram) sum += static_cast<double>(weights(index)) * value;
  return sum;
}

std::vector<double> LinearScores(const CategoryModel& model, const QuantisedImage& picture, CategoryMethod method) {
  const bool with_phrases = method == CategoryMethod::kPhrases;
  const SparseVector words = Hellinger(CountWords(picture, model.vocabulary.size()));
  SparseVector phrases;
  if (with_phrases) {
    phrases = Hellinger(CountPhrases(
        FindPhrases(picture, model.cluster_of_word, model.word_clusters, model.options.phrases), model.word_clusters));
  }
  Eigen::VectorXf compared;
  if (model.shape.size() > 0)
    compared = CompareShapes(model.shape_examples, picture.shape, model.options.shapes.sharpness);
  std::vector<double> scores;
  for (const LinearWeights& weights : with_phrases ? model.phrase_weights : model.word_weights) {
    double score = weights.offset + DotWith(weights.words, words);
    if (model.shape.size() > 0) score += weights.shapes.dot(compared);
    if (with_phrases) score += DotWith(weights.phrases, phrases) + weights.fisher.dot(picture.fisher);
    scores.push_back(score);
  }
  return scores;
}

}  // namespace

bool IsWithin(std::string_view name, std::string_view ancestor) {
  return name.starts_with(ancestor) && (name.size() == ancestor.size() || name[ancestor.size()] == '/');
}

int TrainingTarget(std::string_view category, std::string_view node) {
  if (IsWithin(category, node)) return 1;
  return IsWithin(node, category) ? 0 : -1;
}

QuantisedImage QuantiseFeatures(const CategoryModel& model, const FeatureSet& features) {
  QuantisedImage picture =
      QuantiseFeatures(features, model.vocabulary, model.options.words_per_keypoint, model.options.assignment_sigma);
  picture.fisher = model.fisher.Encode(features);
  picture.shape = model.shape.Encode(features);
  return picture;
}

CategoryResult Classify(const CategoryModel& model, const QuantisedImage& picture, CategoryMethod method) {
  VICTORIOUS_CHECK(!model.nodes.empty());
  const std::vector<double> raw = model.options.scoring == "linear" ? LinearScores(model, picture, method)
                                                                    : LikelihoodScores(model, picture, method);
  CategoryResult result;
  double best = -1;
  for (std::size_t n = 0; n < raw.size(); ++n) {
    const CategoryNode& node = model.nodes[n];
    const Calibration& calibration = method == CategoryMethod::kPhrases ? node.phrases : node.words;
    result.scores.push_back({raw[n], calibration.Probability(raw[n])});
    if (node.can_be_label && result.scores[n].probability > best) {
      best = result.scores[n].probability;
      result.label = n;
    }
  }
  return result;
}

}  // namespace victorious

#include "victorious/category/linear/linear_model.h"

namespace victorious {
namespace {

double DotWith(const Eigen::VectorXf& weights, const SparseVector& histogram) {
  double sum = 0;
  for (const auto& [index, value] : histogram) sum += static_cast<double>(weights(index)) * value;
  return sum;
}

}  // namespace

void LinearOptions::ListFields(FieldList& fields) {
  fields.AddGroup("phrases", phrases);
  fields.AddGroup("fisher", fisher);
  fields.AddGroup("shapes", shapes);
}

QuantisedImage QuantiseForLinear(const LinearModel& model, const FeatureSet& features, const Vocabulary& vocabulary,
                                 int words_per_keypoint) {
  QuantisedImage picture = QuantiseFeatures(features, vocabulary, words_per_keypoint);
  picture.fisher = model.fisher.Encode(features);
  picture.shape = model.shape.Encode(features);
  return picture;
}

LinearInput ComputeLinearInput(const LinearModel& model, const QuantisedImage& picture, CategoryMethod method) {
  LinearInput input;
  input.words = Hellinger(CountWords(picture, model.cluster_of_word.size()));
  if (method == CategoryMethod::kPhrases) {
    input.phrases =
        Hellinger(CountPhrases(FindPhrases(picture, model.cluster_of_word, model.word_clusters), model.word_clusters));
    input.fisher = picture.fisher;
  }
  if (model.shape.size() > 0) input.shapes = CompareShapes(model.shape_examples, picture.shape);
  return input;
}

double LinearScore(const LinearWeights& weights, const LinearInput& input) {
  double score = weights.offset + DotWith(weights.words, input.words);
  if (input.shapes.size() > 0) score += weights.shapes.dot(input.shapes);
  if (weights.phrases.size() > 0) score += DotWith(weights.phrases, input.phrases) + weights.fisher.dot(input.fisher);
  return score;
}

std::vector<double> LinearScores(const LinearModel& model, const QuantisedImage& picture, CategoryMethod method) {
  const LinearInput input = ComputeLinearInput(model, picture, method);
  std::vector<double> scores;
  for (const LinearWeights& weights : method == CategoryMethod::kPhrases ? model.phrase_weights : model.word_weights)
    scores.push_back(LinearScore(weights, input));
  return scores;
}

}  // namespace victorious

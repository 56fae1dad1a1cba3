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
  QuantisedImage image = QuantiseFeatures(features, vocabulary, words_per_keypoint);
  image.fisher = model.fisher.Encode(features);
  image.shape = model.shape.Encode(features);
  return image;
}

LinearInput ComputeLinearInput(const LinearModel& model, const QuantisedImage& image, CategoryMethod method) {
  LinearInput input;
  input.words = Hellinger(CountWords(image, model.cluster_of_word.size()));
  if (method == CategoryMethod::kPhrases) {
    input.phrases =
        Hellinger(CountPhrases(FindPhrases(image, model.cluster_of_word, model.word_clusters), model.word_clusters));
    input.fisher = image.fisher;
  }
  if (model.shape.size() > 0) input.shapes = CompareShapes(model.shape_examples, image.shape);
  return input;
}

double LinearScore(const LinearWeights& weights, const LinearInput& input) {
  double score = weights.offset + DotWith(weights.words, input.words);
  if (input.shapes.size() > 0) score += weights.shapes.dot(input.shapes);
  if (weights.phrases.size() > 0) score += DotWith(weights.phrases, input.phrases) + weights.fisher.dot(input.fisher);
  return score;
}

std::vector<double> LinearScores(const LinearModel& model, const QuantisedImage& image, CategoryMethod method) {
  const LinearInput input = ComputeLinearInput(model, image, method);
  std::vector<double> scores;
  for (const LinearWeights& weights : method == CategoryMethod::kPhrases ? model.phrase_weights : model.word_weights)
    scores.push_back(LinearScore(weights, input));
  return scores;
}

}  // namespace victorious

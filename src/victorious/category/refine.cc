#include "victorious/category/refine.h"

#include <algorithm>

#include <Eigen/Cholesky>
#include <fmt/format.h>

namespace victorious {
namespace {

struct ImageVectors {
  SparseVector words;
  SparseVector phrases;
  Eigen::VectorXf fisher;
};

// Weights of the kernels of phrases and Fisher vectors relative to that of words, which has weight 1.
struct KernelWeights {
  double phrases = 0;
  double fisher = 0;
};

// Target of a mark for a node: +1, -1, or 0 for unknown.
int FeedbackTarget(const CategoryFeedback& mark, const CategoryNode& node) {
  if (mark.right) return TrainingTarget(mark.category, node.name);
  return IsWithin(node.name, mark.category) ? -1 : 0;
}

void AddTo(Eigen::VectorXf& weights, const SparseVector& histogram, double factor) {
  for (const auto& [index, value] : histogram) weights(index) += static_cast<float>(factor * value);
}

double Score(const LinearWeights& weights, const ImageVectors& vectors) {
  double score = weights.offset;
  for (const auto& [word, value] : vectors.words) score += static_cast<double>(weights.words(word)) * value;
  if (weights.phrases.size() == 0) return score;
  for (const auto& [phrase, value] : vectors.phrases) score += static_cast<double>(weights.phrases(phrase)) * value;
  return score + weights.fisher.dot(vectors.fisher);
}

void Refine(std::span<const ImageVectors> vectors, std::span<const int> targets, const KernelWeights& kernel_weights,
            double lambda, LinearWeights& weights) {
  const bool with_phrases = weights.phrases.size() > 0;
  std::vector<const ImageVectors*> used;
  std::vector<double> residuals;  // residuals: target score minus current score
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    const double margin_deficit = 1 - targets[i] * Score(weights, vectors[i]);
    if (targets[i] == 0 || margin_deficit <= 0) continue;
    used.push_back(&vectors[i]);
    residuals.push_back(targets[i] * margin_deficit);
  }
  const auto count = static_cast<Eigen::Index>(used.size());
  Eigen::MatrixXd system(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index j = 0; j < count; ++j) {
      const ImageVectors& a = *used[static_cast<std::size_t>(i)];
      const ImageVectors& b = *used[static_cast<std::size_t>(j)];
      system(i, j) = 1 + Dot(a.words, b.words);
      if (with_phrases)
        system(i, j) +=
            kernel_weights.phrases * Dot(a.phrases, b.phrases) + kernel_weights.fisher * a.fisher.dot(b.fisher);
    }
    system(i, i) += lambda;
  }
  const Eigen::VectorXd alpha = system.ldlt().solve(Eigen::Map<const Eigen::VectorXd>(residuals.data(), count));
  for (Eigen::Index i = 0; i < count; ++i) {
    const ImageVectors& one = *used[static_cast<std::size_t>(i)];
    AddTo(weights.words, one.words, alpha(i));
    if (with_phrases) {
      AddTo(weights.phrases, one.phrases, kernel_weights.phrases * alpha(i));
      weights.fisher += static_cast<float>(kernel_weights.fisher * alpha(i)) * one.fisher;
    }
    weights.offset += static_cast<float>(alpha(i));
  }
}

}  // namespace

Expected<CategoryModel> RefineCategories(CategoryModel model, std::span<const CategoryFeedback> marks) {
  if (model.options.scoring != "linear")
    return Fail(ErrorCode::kUnsupported, "a model with scoring likelihood has no weights to refine: train it again");
  if (model.shape.size() > 0)
    return Fail(ErrorCode::kUnsupported,
                "a model with shapes cannot be refined: add the marked images to its training images, and train again");
  std::vector<ImageVectors> vectors;
  for (const CategoryFeedback& mark : marks) {
    if (std::ranges::find(model.nodes, mark.category, &CategoryNode::name) == model.nodes.end())
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("category {}: not in the model: a new category needs training", mark.category));
    QuantisedImage picture = QuantiseFeatures(model, mark.features);
    const auto phrases = FindPhrases(picture, model.cluster_of_word, model.word_clusters, model.options.phrases);
    vectors.push_back({Hellinger(CountWords(picture, model.vocabulary.size())),
                       Hellinger(CountPhrases(phrases, model.word_clusters)), std::move(picture.fisher)});
  }
  const KernelWeights kernel_weights{.phrases = model.options.phrases.weight, .fisher = model.options.fisher.weight};
  for (std::size_t n = 0; n < model.nodes.size(); ++n) {
    std::vector<int> targets;
    for (const CategoryFeedback& mark : marks) targets.push_back(FeedbackTarget(mark, model.nodes[n]));
    Refine(vectors, targets, kernel_weights, model.options.lambda, model.word_weights[n]);
    Refine(vectors, targets, kernel_weights, model.options.lambda, model.phrase_weights[n]);
  }
  return model;
}

}  // namespace victorious

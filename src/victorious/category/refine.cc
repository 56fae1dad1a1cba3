#include "victorious/category/refine.h"

#include <algorithm>

#include <Eigen/Cholesky>
#include <fmt/format.h>

namespace victorious {
namespace {

struct Seen {
  SparseVector words;
  SparseVector phrases;
  Eigen::VectorXf fisher;
};

// Weights of the kernels of phrases and Fisher vectors relative to that of words, which has weight 1.
struct PartWeights {
  double phrases = 0;
  double fisher = 0;
};

// Target of a mark for a node: +1, -1, or 0 for unknown.
int MarkedTarget(const CategoryMark& mark, const CategoryNode& node) {
  if (mark.right) return TargetOf(mark.category, node.name);
  return IsWithin(node.name, mark.category) ? -1 : 0;
}

void AddTo(Eigen::VectorXf& weights, const SparseVector& histogram, double factor) {
  for (const auto& [index, value] : histogram) weights(index) += static_cast<float>(factor * value);
}

double Score(const LinearWeights& weights, const Seen& seen) {
  double score = weights.offset;
  for (const auto& [word, value] : seen.words) score += static_cast<double>(weights.words(word)) * value;
  if (weights.phrases.size() == 0) return score;
  for (const auto& [phrase, value] : seen.phrases) score += static_cast<double>(weights.phrases(phrase)) * value;
  return score + weights.fisher.dot(seen.fisher);
}

void Refine(std::span<const Seen> seen, std::span<const int> targets, const PartWeights& part, double lambda,
            LinearWeights& weights) {
  const bool with_phrases = weights.phrases.size() > 0;
  std::vector<const Seen*> used;
  std::vector<double> missing;  // residuals: target score minus current score
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const double short_of = 1 - targets[i] * Score(weights, seen[i]);
    if (targets[i] == 0 || short_of <= 0) continue;
    used.push_back(&seen[i]);
    missing.push_back(targets[i] * short_of);
  }
  const auto count = static_cast<Eigen::Index>(used.size());
  Eigen::MatrixXd system(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index j = 0; j < count; ++j) {
      const Seen& a = *used[static_cast<std::size_t>(i)];
      const Seen& b = *used[static_cast<std::size_t>(j)];
      system(i, j) = 1 + Dot(a.words, b.words);
      if (with_phrases) system(i, j) += part.phrases * Dot(a.phrases, b.phrases) + part.fisher * a.fisher.dot(b.fisher);
    }
    system(i, i) += lambda;
  }
  const Eigen::VectorXd alpha = system.ldlt().solve(Eigen::Map<const Eigen::VectorXd>(missing.data(), count));
  for (Eigen::Index i = 0; i < count; ++i) {
    const Seen& one = *used[static_cast<std::size_t>(i)];
    AddTo(weights.words, one.words, alpha(i));
    if (with_phrases) {
      AddTo(weights.phrases, one.phrases, part.phrases * alpha(i));
      weights.fisher += static_cast<float>(part.fisher * alpha(i)) * one.fisher;
    }
    weights.offset += static_cast<float>(alpha(i));
  }
}

}  // namespace

Expected<CategoryModel> RefineCategories(CategoryModel model, std::span<const CategoryMark> marks) {
  if (model.options.scoring != "linear")
    return Fail(ErrorCode::kUnsupported, "a model with scoring likelihood has no weights to refine: train it again");
  if (model.shape.size() > 0)
    return Fail(ErrorCode::kUnsupported,
                "a model with shapes cannot be refined: add the marked images to its training images, and train again");
  std::vector<Seen> seen;
  for (const CategoryMark& mark : marks) {
    if (std::ranges::find(model.nodes, mark.category, &CategoryNode::name) == model.nodes.end())
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("category {}: not in the model: a new category needs training", mark.category));
    WordedPicture picture = WordsOf(model, mark.features);
    const auto phrases = FindPhrases(picture, model.part_of_word, model.parts, model.options.phrases);
    seen.push_back({Hellinger(CountWords(picture, model.vocabulary.size())),
                    Hellinger(CountPhrases(phrases, model.parts)), std::move(picture.fisher)});
  }
  const PartWeights part{.phrases = model.options.phrases.weight, .fisher = model.options.fisher.weight};
  for (std::size_t n = 0; n < model.nodes.size(); ++n) {
    std::vector<int> targets;
    for (const CategoryMark& mark : marks) targets.push_back(MarkedTarget(mark, model.nodes[n]));
    Refine(seen, targets, part, model.options.lambda, model.word_weights[n]);
    Refine(seen, targets, part, model.options.lambda, model.phrase_weights[n]);
  }
  return model;
}

}  // namespace victorious

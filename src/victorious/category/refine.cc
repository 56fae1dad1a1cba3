#include "victorious/category/refine.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "victorious/category/linear/linear_training.h"
#include "victorious/category/linear/ridge.h"

namespace victorious {
namespace {

// Target of a mark for a node: +1, -1, or 0 for unknown.
int FeedbackTarget(const CategoryFeedback& mark, const CategoryNode& node) {
  if (mark.right) return TrainingTarget(mark.category, node.name);
  return IsWithin(node.name, mark.category) ? -1 : 0;
}

void AddTo(Eigen::VectorXf& weights, const SparseVector& histogram, double factor) {
  for (const auto& [index, value] : histogram) weights(index) += static_cast<float>(factor * value);
}

void Refine(std::span<const LinearInput> vectors, std::span<const int> targets, const LinearOptions& options,
            LinearWeights& weights) {
  const bool with_phrases = weights.phrases.size() > 0;
  std::vector<const LinearInput*> used;
  std::vector<double> residuals;  // target score minus current score
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    const double margin_deficit = 1 - targets[i] * LinearScore(weights, vectors[i]);
    if (targets[i] == 0 || margin_deficit <= 0) continue;
    used.push_back(&vectors[i]);
    residuals.push_back(targets[i] * margin_deficit);
  }
  if (used.empty()) return;
  const auto count = static_cast<Eigen::Index>(used.size());
  Eigen::MatrixXd kernel(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index j = 0; j < count; ++j) {
      const LinearInput& a = *used[static_cast<std::size_t>(i)];
      const LinearInput& b = *used[static_cast<std::size_t>(j)];
      kernel(i, j) = 1 + Dot(a.words, b.words);
      if (with_phrases)
        kernel(i, j) +=
            options.phrases.weight * Dot(a.phrases, b.phrases) + options.fisher.weight * a.fisher.dot(b.fisher);
    }
  }
  const Eigen::VectorXd alpha = RegularisedInverse(std::move(kernel), Eigen::VectorXd::Constant(count, kRidgePenalty)) *
                                Eigen::Map<const Eigen::VectorXd>(residuals.data(), count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const LinearInput& one = *used[static_cast<std::size_t>(i)];
    AddTo(weights.words, one.words, alpha(i));
    if (with_phrases) {
      AddTo(weights.phrases, one.phrases, options.phrases.weight * alpha(i));
      weights.fisher += static_cast<float>(options.fisher.weight * alpha(i)) * one.fisher;
    }
    weights.offset += static_cast<float>(alpha(i));
  }
}

}  // namespace

Expected<CategoryModel> RefineCategories(CategoryModel model, std::span<const CategoryFeedback> marks) {
  auto* linear = std::get_if<LinearModel>(&model.classifier);
  if (linear == nullptr)
    return Fail(ErrorCode::kUnsupported, "a model with scoring likelihood has no weights to refine: train it again");
  if (linear->shape.size() > 0)
    return Fail(ErrorCode::kUnsupported,
                "a model with shapes cannot be refined: add the marked images to its training images, and train again");
  std::vector<LinearInput> vectors;
  for (const CategoryFeedback& mark : marks) {
    if (std::ranges::find(model.nodes, mark.category, &CategoryNode::name) == model.nodes.end())
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("category {}: not in the model: a new category needs training", mark.category));
    vectors.push_back(ComputeLinearInput(*linear, QuantiseFeatures(model, mark.features), CategoryMethod::kPhrases));
  }
  for (std::size_t n = 0; n < model.nodes.size(); ++n) {
    std::vector<int> targets;
    for (const CategoryFeedback& mark : marks) targets.push_back(FeedbackTarget(mark, model.nodes[n]));
    Refine(vectors, targets, model.options.linear, linear->word_weights[n]);
    Refine(vectors, targets, model.options.linear, linear->phrase_weights[n]);
  }
  return model;
}

std::size_t CountAgreeing(const CategoryModel& model, std::span<const CategoryFeedback> marks) {
  constexpr double kEvenOdds = 0.5;
  std::size_t count = 0;
  for (const CategoryFeedback& mark : marks) {
    const auto node = std::ranges::find(model.nodes, mark.category, &CategoryNode::name);
    bool is_found = false;
    if (node != model.nodes.end()) {
      const CategoryResult result = Classify(model, QuantiseFeatures(model, mark.features), CategoryMethod::kPhrases);
      is_found = result.scores[static_cast<std::size_t>(node - model.nodes.begin())].probability >= kEvenOdds;
    }
    if (is_found == mark.right) ++count;
  }
  return count;
}

}  // namespace victorious

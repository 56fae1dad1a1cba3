#include "victorious/category/thesis/likelihood.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <opencv2/core/utility.hpp>

#include "victorious/category/common/held_out.h"

namespace victorious {
namespace {

using Indices = std::vector<std::size_t>;

struct LikelihoodFit {
  TopicModel topics;
  std::vector<PhraseGrammar> grammars;
};

// References to the parts of a full model, or of one cross-validation fold.
struct Scorer {
  const CategoryModel& model;
  const Vocabulary& vocabulary;
  const TopicModel& topics;
  std::span<const PhraseGrammar> grammars;
};

QuantisedImage QuantiseWith(const Vocabulary& vocabulary, const FeatureSet& features, const CategoryOptions& options) {
  return QuantiseFeatures(features, vocabulary, options.words_per_keypoint, options.assignment_sigma);
}

LikelihoodFit FitSubset(const Indices& used, std::span<const CategoryExample> examples,
                        std::span<const int> topic_of_picture, const Vocabulary& vocabulary,
                        const CategoryModel& model) {
  const auto topics = static_cast<int>(model.topic_nodes.size());
  std::vector<QuantisedImage> pictures;
  std::vector<WordCounts> counts;
  std::vector<int> topic;
  for (const std::size_t i : used) {
    pictures.push_back(QuantiseWith(vocabulary, examples[i].features, model.options));
    counts.push_back(CountWords(pictures.back(), vocabulary.size()));
    topic.push_back(topic_of_picture[i]);
  }
  LikelihoodFit learned;
  learned.topics = LearnTopics(counts, topic, topics, vocabulary.size(), model.options.plsa, model.options.seed);
  for (int z = 0; z < topics; ++z) {
    std::vector<const QuantisedImage*> own;
    for (std::size_t i = 0; i < used.size(); ++i)
      if (topic[i] == z) own.push_back(&pictures[i]);
    const Eigen::VectorXf likelihoods = learned.topics.word_given_topic.col(z);
    learned.grammars.push_back(PhraseGrammar::Learn(
        own, {likelihoods.data(), static_cast<std::size_t>(likelihoods.size())}, model.options.grammar));
  }
  return learned;
}

std::vector<double> NodeScores(std::span<const double> topic_likelihoods, const CategoryModel& model) {
  // Lower bound of a likelihood: an unseen phrase or word does not exclude a topic.
  constexpr double kMinLikelihood = 1e-12;
  std::vector<double> scores;
  for (const CategoryNode& node : model.nodes) {
    double within = kMinLikelihood;
    double others = kMinLikelihood;
    for (std::size_t z = 0; z < topic_likelihoods.size(); ++z)
      (IsWithin(model.nodes[model.topic_nodes[z]].name, node.name) ? within : others) += topic_likelihoods[z];
    scores.push_back(std::log(within) - std::log(others));
  }
  return scores;
}

std::vector<double> ComputeScores(const Scorer& scorer, const QuantisedImage& picture, CategoryMethod method) {
  const CategoryModel& model = scorer.model;
  const bool by_phrases = method == CategoryMethod::kPhrases;
  std::vector<double> scores(model.nodes.size());
  if (by_phrases) {
    std::vector<double> likelihoods;
    for (const PhraseGrammar& grammar : scorer.grammars) likelihoods.push_back(grammar.Likelihood(picture));
    scores = NodeScores(likelihoods, model);
    for (double& score : scores) score *= model.options.grammar.likelihood_exponent;
  }
  if (!by_phrases || model.options.grammar.word_prior) {
    const WordCounts counts = CountWords(picture, scorer.vocabulary.size());
    const Eigen::VectorXd topic_mixture = InferTopicMixture(scorer.topics, counts, model.options.plsa);
    const std::vector<double> of_words =
        NodeScores({topic_mixture.data(), static_cast<std::size_t>(topic_mixture.size())}, model);
    std::ranges::transform(scores, of_words, scores.begin(), std::plus());
  }
  return scores;
}

// For each example, the index of its image within its category. Folds by this index never hold out a whole category.
std::vector<int> ImageIndicesWithinCategory(std::span<const CategoryExample> examples) {
  std::map<std::string, std::map<int, int>> image_indices;  // by category and picture
  std::vector<int> all;
  for (const CategoryExample& example : examples) {
    std::map<int, int>& own = image_indices[example.category];
    all.push_back(own.try_emplace(example.picture, static_cast<int>(own.size())).first->second);
  }
  return all;
}

}  // namespace

void LearnLikelihoods(std::span<const CategoryExample> examples, CategoryModel& model) {
  for (std::size_t n = 0; n < model.nodes.size(); ++n)
    if (model.nodes[n].can_be_label) model.topic_nodes.push_back(static_cast<std::uint32_t>(n));
  std::vector<int> topic_of_picture;
  for (const CategoryExample& example : examples) {
    const auto topic = std::ranges::find_if(
        model.topic_nodes, [&](std::uint32_t node) { return model.nodes[node].name == example.category; });
    topic_of_picture.push_back(static_cast<int>(topic - model.topic_nodes.begin()));
  }

  constexpr int kFolds = 5;
  const std::vector<int> image_indices = ImageIndicesWithinCategory(examples);
  const auto fold_of = [&](std::size_t i) { return image_indices[i] % kFolds; };
  const auto nodes = static_cast<Eigen::Index>(model.nodes.size());
  const auto count = static_cast<Eigen::Index>(examples.size());
  Eigen::MatrixXd words = Eigen::MatrixXd::Zero(count, nodes);
  Eigen::MatrixXd phrases = words;
  cv::parallel_for_({0, kFolds}, [&](const cv::Range& range) {
    for (int fold = range.start; fold < range.end; ++fold) {
      Indices training;
      for (std::size_t i = 0; i < examples.size(); ++i)
        if (fold_of(i) != fold && examples[i].used_for_training) training.push_back(i);
      std::vector<const FeatureSet*> sets;
      for (const std::size_t i : training) sets.push_back(&examples[i].features);
      if (std::ranges::all_of(sets, [](const FeatureSet* set) { return set->size() == 0; })) continue;
      const Vocabulary vocabulary = Vocabulary::Learn(sets, model.options.vocabulary, model.options.seed);
      const LikelihoodFit learned = FitSubset(training, examples, topic_of_picture, vocabulary, model);
      const Scorer scorer{model, vocabulary, learned.topics, learned.grammars};
      for (std::size_t i = 0; i < examples.size(); ++i) {
        if (fold_of(i) != fold || !examples[i].used_for_calibration) continue;
        const QuantisedImage picture = QuantiseWith(vocabulary, examples[i].features, model.options);
        const auto score = [&](CategoryMethod method) {
          const std::vector<double> scores = ComputeScores(scorer, picture, method);
          return Eigen::RowVectorXd(Eigen::Map<const Eigen::RowVectorXd>(scores.data(), nodes));
        };
        words.row(static_cast<Eigen::Index>(i)) = score(CategoryMethod::kWords);
        phrases.row(static_cast<Eigen::Index>(i)) = score(CategoryMethod::kPhrases);
      }
    }
  });
  for (Eigen::Index n = 0; n < nodes; ++n) {
    CategoryNode& node = model.nodes[static_cast<std::size_t>(n)];
    std::vector<int> targets;
    for (const CategoryExample& example : examples) targets.push_back(TrainingTarget(example.category, node.name));
    node.words = CalibrateHeldOut(examples, targets, words.col(n));
    node.phrases = CalibrateHeldOut(examples, targets, phrases.col(n));
  }

  Indices all;
  for (std::size_t i = 0; i < examples.size(); ++i)
    if (examples[i].used_for_training) all.push_back(i);
  LikelihoodFit learned = FitSubset(all, examples, topic_of_picture, model.vocabulary, model);
  model.topics = std::move(learned.topics);
  model.grammars = std::move(learned.grammars);
}

std::vector<double> LikelihoodScores(const CategoryModel& model, const QuantisedImage& picture, CategoryMethod method) {
  return ComputeScores({model, model.vocabulary, model.topics, model.grammars}, picture, method);
}

}  // namespace victorious

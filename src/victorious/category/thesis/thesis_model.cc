#include "victorious/category/thesis/thesis_model.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <oneapi/tbb/parallel_for.h>

#include "victorious/category/common/held_out.h"

namespace victorious {
namespace {

using Indices = std::vector<std::size_t>;

// What stays the same in all folds.
struct TrainingSetup {
  std::span<const CategoryExample> examples;
  std::span<const std::uint32_t> topic_nodes;
  std::vector<int> topic_of_example;
  VocabularyOptions words;
  ThesisOptions options;
  std::uint64_t seed = 0;
};

// Trains on a subset of the examples.
ThesisModel FitSubset(const TrainingSetup& setup, const Indices& used, const Vocabulary& vocabulary) {
  const auto topics = static_cast<int>(setup.topic_nodes.size());
  std::vector<QuantisedImage> images;
  std::vector<SparseVector> counts;
  std::vector<int> topic;
  for (const std::size_t i : used) {
    images.push_back(QuantiseFeatures(setup.examples[i].features, vocabulary, setup.words.words_per_keypoint));
    counts.push_back(CountWords(images.back(), vocabulary.size()));
    topic.push_back(setup.topic_of_example[i]);
  }
  ThesisModel model;
  model.topic_nodes.assign(setup.topic_nodes.begin(), setup.topic_nodes.end());
  model.topics = LearnTopics(counts, topic, topics, vocabulary.size(), setup.options.plsa, setup.seed);
  for (int z = 0; z < topics; ++z) {
    std::vector<const QuantisedImage*> own;
    for (std::size_t i = 0; i < used.size(); ++i)
      if (topic[i] == z) own.push_back(&images[i]);
    const Eigen::VectorXf likelihoods = model.topics.word_given_topic.col(z);
    model.grammars.push_back(PhraseGrammar::Learn(
        own, {likelihoods.data(), static_cast<std::size_t>(likelihoods.size())}, setup.options.grammar));
  }
  return model;
}

// Log ratio of the likelihood of each node's topics to that of all others.
std::vector<double> NodeScores(std::span<const double> topic_likelihoods, const ThesisModel& model,
                               std::span<const CategoryNode> nodes) {
  // Lower bound of a likelihood: an unseen phrase or word does not exclude a topic.
  constexpr double kMinLikelihood = 1e-12;
  std::vector<double> scores;
  for (const CategoryNode& node : nodes) {
    double within = kMinLikelihood;
    double others = kMinLikelihood;
    for (std::size_t z = 0; z < topic_likelihoods.size(); ++z)
      (IsWithin(nodes[model.topic_nodes[z]].name, node.name) ? within : others) += topic_likelihoods[z];
    scores.push_back(std::log(within) - std::log(others));
  }
  return scores;
}

// For each example, the index of its image within its category. Folds by this index never hold out a whole category.
std::vector<int> ImageIndicesWithinCategory(std::span<const CategoryExample> examples) {
  std::map<std::string, std::map<int, int>> image_indices;  // by category and image
  std::vector<int> all;
  for (const CategoryExample& example : examples) {
    std::map<int, int>& own = image_indices[example.category];
    all.push_back(own.try_emplace(example.image, static_cast<int>(own.size())).first->second);
  }
  return all;
}

}  // namespace

void ThesisOptions::ListFields(FieldList& fields) {
  fields.AddGroup("plsa", plsa);
  fields.AddGroup("grammar", grammar);
}

ThesisFit TrainThesis(std::span<const CategoryExample> examples, std::vector<CategoryNode> nodes,
                      const Vocabulary& vocabulary, const VocabularyOptions& words, const ThesisOptions& options,
                      std::uint64_t seed) {
  std::vector<std::uint32_t> topic_nodes;
  for (std::size_t n = 0; n < nodes.size(); ++n)
    if (nodes[n].can_be_label) topic_nodes.push_back(static_cast<std::uint32_t>(n));
  TrainingSetup setup{.examples = examples,
                      .topic_nodes = topic_nodes,
                      .topic_of_example = {},
                      .words = words,
                      .options = options,
                      .seed = seed};
  for (const CategoryExample& example : examples) {
    const auto topic = std::ranges::find(topic_nodes, example.category,
                                         [&](std::uint32_t node) -> const std::string& { return nodes[node].name; });
    setup.topic_of_example.push_back(static_cast<int>(topic - topic_nodes.begin()));
  }

  constexpr int kFolds = 5;
  const std::vector<int> image_indices = ImageIndicesWithinCategory(examples);
  const auto fold_of = [&](std::size_t i) { return image_indices[i] % kFolds; };
  const auto node_count = static_cast<Eigen::Index>(nodes.size());
  Eigen::MatrixXd by_words = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(examples.size()), node_count);
  Eigen::MatrixXd by_phrases = by_words;
  oneapi::tbb::parallel_for(0, kFolds, [&](int fold) {
    Indices training;
    for (std::size_t i = 0; i < examples.size(); ++i)
      if (fold_of(i) != fold && examples[i].used_for_training) training.push_back(i);
    std::vector<const FeatureSet*> sets;
    for (const std::size_t i : training) sets.push_back(&examples[i].features);
    if (std::ranges::all_of(sets, [](const FeatureSet* set) { return set->size() == 0; })) return;
    const Vocabulary fold_vocabulary = Vocabulary::Learn(sets, words, seed);
    const ThesisModel model = FitSubset(setup, training, fold_vocabulary);
    for (std::size_t i = 0; i < examples.size(); ++i) {
      if (fold_of(i) != fold || !examples[i].used_for_calibration) continue;
      const QuantisedImage image = QuantiseFeatures(examples[i].features, fold_vocabulary, words.words_per_keypoint);
      const auto score = [&](CategoryMethod method) {
        const std::vector<double> scores = ThesisScores(model, nodes, options, image, method);
        return Eigen::RowVectorXd(Eigen::Map<const Eigen::RowVectorXd>(scores.data(), node_count));
      };
      by_words.row(static_cast<Eigen::Index>(i)) = score(CategoryMethod::kWords);
      by_phrases.row(static_cast<Eigen::Index>(i)) = score(CategoryMethod::kPhrases);
    }
  });

  Indices all;
  for (std::size_t i = 0; i < examples.size(); ++i)
    if (examples[i].used_for_training) all.push_back(i);
  ThesisModel model = FitSubset(setup, all, vocabulary);
  for (Eigen::Index n = 0; n < node_count; ++n) {
    CategoryNode& node = nodes[static_cast<std::size_t>(n)];
    std::vector<int> targets;
    for (const CategoryExample& example : examples) targets.push_back(TrainingTarget(example.category, node.name));
    node.words = CalibrateHeldOut(examples, targets, by_words.col(n));
    node.phrases = CalibrateHeldOut(examples, targets, by_phrases.col(n));
  }
  return {.model = std::move(model), .nodes = std::move(nodes)};
}

std::vector<double> ThesisScores(const ThesisModel& model, std::span<const CategoryNode> nodes,
                                 const ThesisOptions& options, const QuantisedImage& image, CategoryMethod method) {
  const bool by_phrases = method == CategoryMethod::kPhrases;
  std::vector<double> scores(nodes.size());
  if (by_phrases) {
    std::vector<double> likelihoods;
    for (const PhraseGrammar& grammar : model.grammars) likelihoods.push_back(grammar.Likelihood(image));
    scores = NodeScores(likelihoods, model, nodes);
    for (double& score : scores) score *= options.grammar.likelihood_exponent;
  }
  if (!by_phrases || options.grammar.word_prior) {
    const SparseVector counts = CountWords(image, static_cast<std::size_t>(model.topics.word_given_topic.rows()));
    const Eigen::VectorXd topic_mixture = InferTopicMixture(model.topics, counts, options.plsa);
    const std::vector<double> of_words =
        NodeScores({topic_mixture.data(), static_cast<std::size_t>(topic_mixture.size())}, model, nodes);
    std::ranges::transform(scores, of_words, scores.begin(), std::plus());
  }
  return scores;
}

}  // namespace victorious

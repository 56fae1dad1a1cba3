#include "victorious/category/likelihood.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <opencv2/core/utility.hpp>

#include "victorious/category/held_out.h"

namespace victorious {
namespace {

using Indices = std::vector<std::size_t>;

struct Learned {
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

WordedPicture WordsBy(const Vocabulary& vocabulary, const FeatureSet& features, const CategoryOptions& options) {
  return WordsOf(features, vocabulary, options.soft_words, options.softness);
}

Learned LearnOn(const Indices& used, std::span<const CategoryExample> examples, std::span<const int> topic_of_picture,
                const Vocabulary& vocabulary, const CategoryModel& model) {
  const auto topics = static_cast<int>(model.topic_nodes.size());
  std::vector<WordedPicture> pictures;
  std::vector<WordCounts> counts;
  std::vector<int> topic;
  for (const std::size_t i : used) {
    pictures.push_back(WordsBy(vocabulary, examples[i].features, model.options));
    counts.push_back(CountWords(pictures.back(), vocabulary.size()));
    topic.push_back(topic_of_picture[i]);
  }
  Learned learned;
  learned.topics = LearnTopics(counts, topic, topics, vocabulary.size(), model.options.plsa, model.options.seed);
  for (int z = 0; z < topics; ++z) {
    std::vector<const WordedPicture*> own;
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
  constexpr double kLeast = 1e-12;
  std::vector<double> scores;
  for (const CategoryNode& node : model.nodes) {
    double within = kLeast;
    double others = kLeast;
    for (std::size_t z = 0; z < topic_likelihoods.size(); ++z)
      (IsWithin(model.nodes[model.topic_nodes[z]].name, node.name) ? within : others) += topic_likelihoods[z];
    scores.push_back(std::log(within) - std::log(others));
  }
  return scores;
}

std::vector<double> ScoresBy(const Scorer& scorer, const WordedPicture& picture, CategoryMethod method) {
  const CategoryModel& model = scorer.model;
  const bool by_phrases = method == CategoryMethod::kPhrases;
  std::vector<double> scores(model.nodes.size());
  if (by_phrases) {
    std::vector<double> likelihoods;
    for (const PhraseGrammar& grammar : scorer.grammars) likelihoods.push_back(grammar.Likelihood(picture));
    scores = NodeScores(likelihoods, model);
    for (double& score : scores) score *= model.options.grammar.power;
  }
  if (!by_phrases || model.options.grammar.word_prior) {
    const WordCounts counts = CountWords(picture, scorer.vocabulary.size());
    const Eigen::VectorXd shares = TopicShares(scorer.topics, counts, model.options.plsa);
    const std::vector<double> of_words = NodeScores({shares.data(), static_cast<std::size_t>(shares.size())}, model);
    std::ranges::transform(scores, of_words, scores.begin(), std::plus());
  }
  return scores;
}

// For each example, the index of its image within its category. Folds by this index never hold out a whole category.
std::vector<int> NumbersWithinCategories(std::span<const CategoryExample> examples) {
  std::map<std::string, std::map<int, int>> numbers;  // by category and picture
  std::vector<int> all;
  for (const CategoryExample& example : examples) {
    std::map<int, int>& own = numbers[example.category];
    all.push_back(own.try_emplace(example.picture, static_cast<int>(own.size())).first->second);
  }
  return all;
}

}  // namespace

void LearnLikelihoods(std::span<const CategoryExample> examples, CategoryModel& model) {
  for (std::size_t n = 0; n < model.nodes.size(); ++n)
    if (model.nodes[n].labels) model.topic_nodes.push_back(static_cast<std::uint32_t>(n));
  std::vector<int> topic_of_picture;
  for (const CategoryExample& example : examples) {
    const auto topic = std::ranges::find_if(
        model.topic_nodes, [&](std::uint32_t node) { return model.nodes[node].name == example.category; });
    topic_of_picture.push_back(static_cast<int>(topic - model.topic_nodes.begin()));
  }

  constexpr int kParts = 5;
  const std::vector<int> numbers = NumbersWithinCategories(examples);
  const auto part_of = [&](std::size_t i) { return numbers[i] % kParts; };
  const auto nodes = static_cast<Eigen::Index>(model.nodes.size());
  const auto count = static_cast<Eigen::Index>(examples.size());
  Eigen::MatrixXd words = Eigen::MatrixXd::Zero(count, nodes);
  Eigen::MatrixXd phrases = words;
  cv::parallel_for_({0, kParts}, [&](const cv::Range& range) {
    for (int part = range.start; part < range.end; ++part) {
      Indices rest;
      for (std::size_t i = 0; i < examples.size(); ++i)
        if (part_of(i) != part && examples[i].learns) rest.push_back(i);
      std::vector<const FeatureSet*> sets;
      for (const std::size_t i : rest) sets.push_back(&examples[i].features);
      if (std::ranges::all_of(sets, [](const FeatureSet* set) { return set->size() == 0; })) continue;
      const Vocabulary vocabulary = Vocabulary::Learn(sets, model.options.vocabulary, model.options.seed);
      const Learned learned = LearnOn(rest, examples, topic_of_picture, vocabulary, model);
      const Scorer scorer{model, vocabulary, learned.topics, learned.grammars};
      for (std::size_t i = 0; i < examples.size(); ++i) {
        if (part_of(i) != part || !examples[i].calibrates) continue;
        const WordedPicture picture = WordsBy(vocabulary, examples[i].features, model.options);
        const auto score = [&](CategoryMethod method) {
          const std::vector<double> scores = ScoresBy(scorer, picture, method);
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
    for (const CategoryExample& example : examples) targets.push_back(TargetOf(example.category, node.name));
    node.words = CalibrateOn(examples, targets, words.col(n));
    node.phrases = CalibrateOn(examples, targets, phrases.col(n));
  }

  Indices all;
  for (std::size_t i = 0; i < examples.size(); ++i)
    if (examples[i].learns) all.push_back(i);
  Learned learned = LearnOn(all, examples, topic_of_picture, model.vocabulary, model);
  model.topics = std::move(learned.topics);
  model.grammars = std::move(learned.grammars);
}

std::vector<double> LikelihoodScores(const CategoryModel& model, const WordedPicture& picture, CategoryMethod method) {
  return ScoresBy({model, model.vocabulary, model.topics, model.grammars}, picture, method);
}

}  // namespace victorious

#include "victorious/category/likelihood.h"

#include <algorithm>
#include <cmath>

#include <opencv2/core/utility.hpp>

#include "victorious/category/held_out.h"

namespace victorious {
namespace {

using Indices = std::vector<std::size_t>;

struct Learned {
  TopicModel topics;
  std::vector<PhraseGrammar> grammars;
};

Learned LearnOn(const Indices& used, std::span<const WordedPicture> pictures, std::span<const int> topic_of_picture,
                int topics, const CategoryModel& model) {
  std::vector<WordCounts> counts;
  std::vector<int> topic;
  for (const std::size_t i : used) {
    counts.push_back(CountWords(pictures[i], model.vocabulary.size()));
    topic.push_back(topic_of_picture[i]);
  }
  Learned learned;
  learned.topics = LearnTopics(counts, topic, topics, model.vocabulary.size(), model.options.plsa, model.options.seed);
  for (int z = 0; z < topics; ++z) {
    std::vector<const WordedPicture*> own;
    for (const std::size_t i : used)
      if (topic_of_picture[i] == z) own.push_back(&pictures[i]);
    const Eigen::VectorXf likelihoods = learned.topics.word_given_topic.col(z);
    learned.grammars.push_back(PhraseGrammar::Learn(
        own, {likelihoods.data(), static_cast<std::size_t>(likelihoods.size())}, model.options.grammar));
  }
  return learned;
}

// How likely the picture is under each topic; of words, each topic's share of it.
std::vector<double> TopicLikelihoods(const TopicModel& topics, std::span<const PhraseGrammar> grammars,
                                     const WordedPicture& picture, const CategoryModel& model, CategoryMethod method) {
  std::vector<double> likelihoods;
  if (method == CategoryMethod::kWords) {
    const WordCounts counts = CountWords(picture, model.vocabulary.size());
    const Eigen::VectorXd shares = TopicShares(topics, counts, model.options.plsa);
    likelihoods.assign(shares.begin(), shares.end());
  } else {
    for (const PhraseGrammar& grammar : grammars) likelihoods.push_back(grammar.Likelihood(picture));
  }
  return likelihoods;
}

std::vector<double> NodeScores(std::span<const double> topic_likelihoods, const CategoryModel& model) {
  // What no training picture ever showed is unlikely, not impossible.
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

}  // namespace

void LearnLikelihoods(std::span<const CategoryExample> examples, std::span<const WordedPicture> pictures,
                      CategoryModel& model) {
  for (std::size_t n = 0; n < model.nodes.size(); ++n)
    if (model.nodes[n].labels) model.topic_nodes.push_back(static_cast<std::uint32_t>(n));
  std::vector<int> topic_of_picture;
  for (const CategoryExample& example : examples) {
    const auto topic = std::ranges::find_if(
        model.topic_nodes, [&](std::uint32_t node) { return model.nodes[node].name == example.category; });
    topic_of_picture.push_back(static_cast<int>(topic - model.topic_nodes.begin()));
  }
  const auto topics = static_cast<int>(model.topic_nodes.size());

  constexpr int kParts = 5;
  const auto part_of = [&](std::size_t i) { return examples[i].picture % kParts; };
  const auto nodes = static_cast<Eigen::Index>(model.nodes.size());
  const auto count = static_cast<Eigen::Index>(examples.size());
  Eigen::MatrixXd words = Eigen::MatrixXd::Zero(count, nodes);
  Eigen::MatrixXd phrases = words;
  cv::parallel_for_({0, kParts}, [&](const cv::Range& range) {
    for (int part = range.start; part < range.end; ++part) {
      Indices rest;
      for (std::size_t i = 0; i < examples.size(); ++i)
        if (part_of(i) != part && examples[i].learns) rest.push_back(i);
      const Learned learned = LearnOn(rest, pictures, topic_of_picture, topics, model);
      for (std::size_t i = 0; i < examples.size(); ++i) {
        if (part_of(i) != part || !examples[i].calibrates) continue;
        const auto score = [&](CategoryMethod method) {
          const auto scores =
              NodeScores(TopicLikelihoods(learned.topics, learned.grammars, pictures[i], model, method), model);
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
  Learned learned = LearnOn(all, pictures, topic_of_picture, topics, model);
  model.topics = std::move(learned.topics);
  model.grammars = std::move(learned.grammars);
}

std::vector<double> LikelihoodScores(const CategoryModel& model, const WordedPicture& picture, CategoryMethod method) {
  return NodeScores(TopicLikelihoods(model.topics, model.grammars, picture, model, method), model);
}

}  // namespace victorious

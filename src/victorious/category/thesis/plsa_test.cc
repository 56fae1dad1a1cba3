#include "victorious/category/thesis/plsa.h"

#include <gtest/gtest.h>

#include "victorious/base/random.h"

namespace victorious {
namespace {

// Images of two topics: topic 0 has the words 0 to 9, topic 1 the words 5 to 14.
std::vector<SparseVector> MakeWordCounts(std::vector<int>& topics) {
  Random random(4);
  std::vector<SparseVector> images;
  for (int d = 0; d < 40; ++d) {
    topics.push_back(d % 2);
    SparseVector counts;
    for (std::uint32_t word = 0; word < 10; ++word)
      counts.emplace_back(word + (d % 2 == 0 ? 0U : 5U), 1.0F + static_cast<float>(random.Below(5)));
    images.push_back(counts);
  }
  return images;
}

TEST(Plsa, LearnsTheWordsOfTopics) {
  std::vector<int> topics;
  const auto images = MakeWordCounts(topics);
  const TopicModel model = LearnTopics(images, topics, 2, 15, PlsaOptions(), 1);
  EXPECT_NEAR(model.word_given_topic.col(0).sum(), 1, 1e-4);
  EXPECT_GT(model.word_given_topic(0, 0), 20 * model.word_given_topic(0, 1));
  EXPECT_GT(model.word_given_topic(14, 1), 20 * model.word_given_topic(14, 0));
  EXPECT_NEAR(model.word_given_topic(7, 0) / model.word_given_topic(7, 1), 1, 0.5);
}

TEST(Plsa, FoldsInNewImages) {
  std::vector<int> topics;
  const auto images = MakeWordCounts(topics);
  const TopicModel model = LearnTopics(images, topics, 2, 15, PlsaOptions(), 1);
  EXPECT_GT(InferTopicMixture(model, {{0, 3.0F}, {6, 1.0F}}, PlsaOptions())(0), 0.9);
  EXPECT_GT(InferTopicMixture(model, {{6, 1.0F}, {13, 3.0F}}, PlsaOptions())(1), 0.9);
  EXPECT_NEAR(InferTopicMixture(model, {{1, 3.0F}, {13, 3.0F}}, PlsaOptions())(1), 0.5, 0.2);
  EXPECT_EQ(InferTopicMixture(model, {}, PlsaOptions())(0), 0.5);
}

TEST(Plsa, IsDeterministicBySeed) {
  std::vector<int> topics;
  const auto images = MakeWordCounts(topics);
  const auto learn = [&](std::uint64_t seed) {
    return LearnTopics(images, topics, 2, 15, {.iterations = 3, .label_weight = 0}, seed).word_given_topic;
  };
  EXPECT_EQ(learn(1), learn(1));
  EXPECT_NE(learn(1), learn(2));
}

}  // namespace
}  // namespace victorious

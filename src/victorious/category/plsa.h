// Probabilistic latent semantic analysis: a picture's words are a mixture of topics, P(w|d) = sum over z P(w|z) P(z|d),
// one topic a category. Source: T. Hofmann, "Probabilistic latent semantic indexing", SIGIR 1999; thesis,
// section 2.1.2. Method: tempered expectation-maximisation, P(z|d,w) ~ (P(w|z) P(z|d))^beta, from several starts, of
// which the one of highest likelihood stays. What a training picture shows is known: its P(z|d) is drawn towards its
// own category.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "victorious/base/options.h"

namespace victorious {

struct PlsaOptions {
  int iterations = 40;
  int restarts = 3;
  double temper = 1.0;
  double label_weight = 4.0;
  double word_floor = 0.05;

  void ListFields(FieldList& fields);
};

/// How often each word occurs in a picture, by rising word.
using WordCounts = std::vector<std::pair<std::uint32_t, float>>;

struct TopicModel {
  Eigen::MatrixXf word_given_topic;  ///< words x topics; each column sums to 1
};

/// @param topic_of_picture  of each picture, below `topics`
TopicModel LearnTopics(std::span<const WordCounts> pictures, std::span<const int> topic_of_picture, int topics,
                       std::size_t words, const PlsaOptions& options, std::uint64_t seed);

/// P(z|d) of a new picture: the same iteration with P(w|z) held fixed. Even where the picture has no words.
Eigen::VectorXd TopicShares(const TopicModel& model, const WordCounts& picture, const PlsaOptions& options);

}  // namespace victorious

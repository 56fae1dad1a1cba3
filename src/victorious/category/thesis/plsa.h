// Probabilistic latent semantic analysis: an image's words are a mixture of topics, P(w|d) = sum over z P(w|z) P(z|d),
// with one topic per category.
// Method: expectation-maximisation, P(z|d,w) ~ P(w|z) P(z|d), with random restarts; the result of the
// highest likelihood is kept. Training is supervised: the category of a training image acts as a prior on its P(z|d).
// Source: T. Hofmann, "Probabilistic latent semantic indexing", SIGIR 1999; thesis, section 2.1.2.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "victorious/base/options.h"
#include "victorious/category/common/word_histogram.h"

namespace victorious {

struct PlsaOptions {
  int iterations = 40;
  int restarts = 3;           ///< random restarts; the most likely result is kept. Not a user parameter
  double label_weight = 4.0;  ///< weight of the category of a training image relative to its words; 0: initialisation
                              ///< only. Not a user parameter

  void ListFields(FieldList& fields);
};

struct TopicModel {
  Eigen::MatrixXf word_given_topic;  ///< P(w|z), words x topics; each column sums to 1
};

/// Learns P(w|z). Deterministic for a given seed.
/// @param topic_of_image  topic index of each image, below `topics`
/// @param topics            number of topics
/// @param words             size of the vocabulary
TopicModel LearnTopics(std::span<const SparseVector> images, std::span<const int> topic_of_image, int topics,
                       std::size_t words, const PlsaOptions& options, std::uint64_t seed);

/// Estimates P(z|d) of a new image by the same iteration with P(w|z) held fixed (folding-in). Uniform for an image
/// without words.
Eigen::VectorXd InferTopicMixture(const TopicModel& model, const SparseVector& image, const PlsaOptions& options);

}  // namespace victorious

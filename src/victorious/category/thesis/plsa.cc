#include "victorious/category/thesis/plsa.h"

#include <cmath>
#include <limits>

#include "victorious/base/check.h"
#include "victorious/base/random.h"

namespace victorious {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Pseudo-count of every word in every topic, so that an unseen word does not exclude a topic.
constexpr double kWordPseudocount = 0.05;

double Sum(const SparseVector& image) {
  double sum = 0;
  for (const auto& [word, count] : image) sum += count;
  return sum;
}

void NormaliseColumns(MatrixXd& matrix) {
  for (Eigen::Index column = 0; column < matrix.cols(); ++column) matrix.col(column) /= matrix.col(column).sum();
}

// P(z|d,w) of one word; sets `likelihood` to P(w|d).
VectorXd Posterior(const VectorXd& joint, double& likelihood) {
  likelihood = joint.sum();
  return joint / std::max(likelihood, std::numeric_limits<double>::min());
}

struct Fit {
  MatrixXd word_given_topic;
  double log_likelihood = 0;
};

Fit FitFromRandomStart(std::span<const SparseVector> images, const MatrixXd& label_fraction, std::size_t words,
                       const PlsaOptions& options, Random& random) {
  const Eigen::Index topics = label_fraction.rows();
  Fit fit;
  fit.word_given_topic.resize(static_cast<Eigen::Index>(words), topics);
  for (double& value : fit.word_given_topic.reshaped()) value = 1 + random.Uniform();
  NormaliseColumns(fit.word_given_topic);
  // Initial P(z|d): the labels, smoothed, because EM never leaves a probability of 0.
  constexpr double kSoftening = 0.05;
  MatrixXd topic_given_image = label_fraction.array() + kSoftening;
  NormaliseColumns(topic_given_image);
  for (int iteration = 0; iteration < options.iterations; ++iteration) {
    MatrixXd word_sums = MatrixXd::Constant(static_cast<Eigen::Index>(words), topics, kWordPseudocount);
    fit.log_likelihood = 0;
    for (std::size_t d = 0; d < images.size(); ++d) {
      const auto column = static_cast<Eigen::Index>(d);
      VectorXd topic_mixture = label_fraction.col(column) * options.label_weight * Sum(images[d]);
      for (const auto& [word, count] : images[d]) {
        double likelihood = 0;
        const VectorXd joint = fit.word_given_topic.row(word).transpose().cwiseProduct(topic_given_image.col(column));
        const VectorXd expected_counts = count * Posterior(joint, likelihood);
        word_sums.row(word) += expected_counts.transpose();
        topic_mixture += expected_counts;
        fit.log_likelihood += count * std::log(std::max(likelihood, std::numeric_limits<double>::min()));
      }
      if (topic_mixture.sum() > 0) topic_given_image.col(column) = topic_mixture / topic_mixture.sum();
    }
    fit.word_given_topic = std::move(word_sums);
    NormaliseColumns(fit.word_given_topic);
  }
  return fit;
}

}  // namespace

void PlsaOptions::ListFields(FieldList& fields) {
  fields.Add("iterations", iterations, {.min = 1, .max = 10000, .reason = "iterations of expectation-maximisation"});
}

TopicModel LearnTopics(std::span<const SparseVector> images, std::span<const int> topic_of_image, int topics,
                       std::size_t words, const PlsaOptions& options, std::uint64_t seed) {
  VICTORIOUS_CHECK(images.size() == topic_of_image.size());
  MatrixXd label_fraction = MatrixXd::Zero(topics, static_cast<Eigen::Index>(images.size()));
  for (std::size_t d = 0; d < images.size(); ++d) label_fraction(topic_of_image[d], static_cast<Eigen::Index>(d)) = 1;
  Random random(seed);
  Fit best;
  for (int start = 0; start < options.restarts; ++start) {
    Fit fit = FitFromRandomStart(images, label_fraction, words, options, random);
    if (start == 0 || fit.log_likelihood > best.log_likelihood) best = std::move(fit);
  }
  return {.word_given_topic = best.word_given_topic.cast<float>()};
}

VectorXd InferTopicMixture(const TopicModel& model, const SparseVector& image, const PlsaOptions& options) {
  const Eigen::Index topics = model.word_given_topic.cols();
  VectorXd topic_mixture = VectorXd::Constant(topics, 1.0 / static_cast<double>(topics));
  for (int iteration = 0; iteration < options.iterations; ++iteration) {
    VectorXd sums = VectorXd::Zero(topics);
    for (const auto& [word, count] : image) {
      double likelihood = 0;
      const VectorXd joint = model.word_given_topic.row(word).transpose().cast<double>().cwiseProduct(topic_mixture);
      sums += count * Posterior(joint, likelihood);
    }
    if (sums.sum() > 0) topic_mixture = sums / sums.sum();
  }
  return topic_mixture;
}

}  // namespace victorious

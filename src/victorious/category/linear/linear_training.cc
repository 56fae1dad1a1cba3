#include "victorious/category/linear/linear_training.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include "victorious/category/common/held_out.h"
#include "victorious/category/linear/ridge.h"

namespace victorious {
namespace {

// Clusters the words by k-means on their centres.
void ClusterWords(const Vocabulary& vocabulary, VocabularyOptions options, int word_clusters, std::uint64_t seed,
                  LinearModel& model) {
  options.words = word_clusters;
  options.root = false;  // the centres are already square-rooted
  const Vocabulary clusters = Vocabulary::Learn(vocabulary.centres(), options, seed);
  model.word_clusters = clusters.size();
  for (const kernels::Neighbour& cluster : clusters.NearestWords(vocabulary.centres(), 1))
    model.cluster_of_word.push_back(static_cast<std::uint16_t>(cluster.index));
}

std::vector<QuantisedImage> QuantiseExamples(std::span<const CategoryExample> examples, const LinearModel& model,
                                             const Vocabulary& vocabulary, int words_per_keypoint) {
  std::vector<QuantisedImage> images(examples.size());
  oneapi::tbb::parallel_for(std::size_t{0}, examples.size(), [&](std::size_t i) {
    images[i] = QuantiseForLinear(model, examples[i].features, vocabulary, words_per_keypoint);
  });
  return images;
}

// Input of the linear classifier for all examples.
struct TrainingData {
  std::vector<SparseVector> words;
  std::vector<SparseVector> phrases;
  Eigen::MatrixXf fisher;  // one column per example
  Eigen::MatrixXf shapes;  // one column per example
};

TrainingData ComputeTrainingData(const LinearModel& model, std::span<const QuantisedImage> images) {
  TrainingData training_data{
      .words = std::vector<SparseVector>(images.size()),
      .phrases = std::vector<SparseVector>(images.size()),
      .fisher = {static_cast<Eigen::Index>(model.fisher.size()), static_cast<Eigen::Index>(images.size())},
      .shapes = {static_cast<Eigen::Index>(model.shape.size()), static_cast<Eigen::Index>(images.size())}};
  oneapi::tbb::parallel_for(std::size_t{0}, images.size(), [&](std::size_t i) {
    const auto phrases = FindPhrases(images[i], model.cluster_of_word, model.word_clusters);
    training_data.words[i] = Hellinger(CountWords(images[i], model.cluster_of_word.size()));
    training_data.phrases[i] = Hellinger(CountPhrases(phrases, model.word_clusters));
    training_data.fisher.col(static_cast<Eigen::Index>(i)) = images[i].fisher;
    training_data.shapes.col(static_cast<Eigen::Index>(i)) = images[i].shape;
  });
  return training_data;
}

// Kernel matrix of sparse vectors.
// @param size  dimension of the vectors
Eigen::MatrixXd KernelMatrix(std::span<const SparseVector> vectors, std::size_t size) {
  const auto count = static_cast<Eigen::Index>(vectors.size());
  Eigen::MatrixXd kernel(count, count);
  const oneapi::tbb::blocked_range<Eigen::Index> rows(0, count);
  oneapi::tbb::parallel_for(rows, [&](const oneapi::tbb::blocked_range<Eigen::Index>& range) {
    std::vector<float> dense(size);
    for (Eigen::Index i = range.begin(); i < range.end(); ++i) {
      const SparseVector& own = vectors[static_cast<std::size_t>(i)];
      for (const auto& [index, value] : own) dense[index] = value;
      for (Eigen::Index j = 0; j <= i; ++j) {
        float sum = 0;
        for (const auto& [index, value] : vectors[static_cast<std::size_t>(j)]) sum += value * dense[index];
        kernel(i, j) = kernel(j, i) = sum;
      }
      for (const auto& [index, value] : own) dense[index] = 0;
    }
  });
  return kernel;
}

Eigen::MatrixXd KernelMatrix(const Eigen::MatrixXf& columns) {
  Eigen::MatrixXf kernel = Eigen::MatrixXf::Zero(columns.cols(), columns.cols());
  if (columns.rows() == 0) return kernel.cast<double>();  // Eigen 3.4's rankUpdate divides by rows()
  kernel.selfadjointView<Eigen::Lower>().rankUpdate(columns.transpose());
  return Eigen::MatrixXf(kernel.selfadjointView<Eigen::Lower>()).cast<double>();
}

// Primal weights: the sum over the examples of alpha times the vector.
Eigen::VectorXf PrimalWeights(std::span<const SparseVector> vectors, const Eigen::VectorXd& alpha, std::size_t size) {
  Eigen::VectorXf weights = Eigen::VectorXf::Zero(static_cast<Eigen::Index>(size));
  for (std::size_t i = 0; i < vectors.size(); ++i)
    for (const auto& [index, value] : vectors[i])
      weights(index) += static_cast<float>(alpha(static_cast<Eigen::Index>(i)) * value);
  return weights;
}

// Which examples the classifier is trained on, one entry per example.
using Trained = std::vector<bool>;

// Penalties that give all categories equal total weight; their mean over the trained examples is kRidgePenalty.
Eigen::VectorXd BalancedPenalties(std::span<const CategoryExample> examples, const Trained& trained) {
  std::map<std::string, double> count;
  double all = 0;
  for (std::size_t i = 0; i < examples.size(); ++i) {
    if (!trained[i]) continue;
    count[examples[i].category] += 1;
    all += 1;
  }
  Eigen::VectorXd penalties(static_cast<Eigen::Index>(examples.size()));
  for (std::size_t i = 0; i < examples.size(); ++i) {
    const double of_category = count.contains(examples[i].category) ? count[examples[i].category] : 1;
    penalties(static_cast<Eigen::Index>(i)) = kRidgePenalty * of_category * static_cast<double>(count.size()) / all;
  }
  return penalties;
}

// Dual weights and calibrations of all nodes for one method. Nodes with the same training examples share a
// factorisation.
struct NodeFits {
  Eigen::MatrixXd alpha;  // one column per node
  std::vector<Calibration> calibrations;
};

NodeFits FitNodes(const Eigen::MatrixXd& kernel, std::span<const CategoryExample> examples, const Trained& trained,
                  std::span<const CategoryNode> category_nodes) {
  std::vector<int> groups;
  for (const CategoryExample& example : examples) groups.push_back(example.image);
  const Eigen::VectorXd penalties = BalancedPenalties(examples, trained);
  const auto rows = static_cast<Eigen::Index>(examples.size());
  std::map<Trained, std::vector<Eigen::Index>> nodes_by_examples;  // by their training examples
  Eigen::MatrixXi targets(rows, static_cast<Eigen::Index>(category_nodes.size()));
  for (Eigen::Index n = 0; n < targets.cols(); ++n) {
    Trained trained_for_node;
    for (std::size_t i = 0; i < examples.size(); ++i) {
      const int target = TrainingTarget(examples[i].category, category_nodes[static_cast<std::size_t>(n)].name);
      targets(static_cast<Eigen::Index>(i), n) = target;
      trained_for_node.push_back(trained[i] && target != 0);
    }
    nodes_by_examples[trained_for_node].push_back(n);
  }
  NodeFits fits{.alpha = {rows, targets.cols()}, .calibrations = std::vector<Calibration>(category_nodes.size())};
  for (const auto& [trained_for_nodes, nodes] : nodes_by_examples) {
    Eigen::MatrixXi learned = targets(Eigen::all, nodes);
    for (Eigen::Index i = 0; i < rows; ++i)
      if (!trained_for_nodes[static_cast<std::size_t>(i)]) learned.row(i).setZero();
    const RidgeFit fit = FitRidge(kernel, learned, groups, penalties);
    fits.alpha(Eigen::all, nodes) = fit.alpha;
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      const Eigen::VectorXi column = targets.col(nodes[k]);
      fits.calibrations[static_cast<std::size_t>(nodes[k])] =
          CalibrateHeldOut(examples, {column.data(), examples.size()}, fit.held_out.col(static_cast<Eigen::Index>(k)));
    }
  }
  return fits;
}

Trained WithoutMirrored(std::span<const CategoryExample> examples, Trained trained,
                        const std::set<std::string>& categories) {
  for (std::size_t i = 0; i < examples.size(); ++i)
    trained[i] = trained[i] && !(examples[i].mirrored && categories.contains(examples[i].category));
  return trained;
}

// Number of confusions for each pair of categories, by held-out scores.
using Confusions = std::map<std::pair<std::string, std::string>, int>;

Confusions CountConfusions(const Eigen::MatrixXd& kernel, std::span<const CategoryExample> examples,
                           const Trained& trained, const std::set<std::string>& categories) {
  const std::vector<std::string> names(categories.begin(), categories.end());
  std::vector<int> groups;
  Eigen::MatrixXi targets(static_cast<Eigen::Index>(examples.size()), static_cast<Eigen::Index>(names.size()));
  for (std::size_t i = 0; i < examples.size(); ++i) {
    groups.push_back(examples[i].image);
    for (std::size_t c = 0; c < names.size(); ++c) {
      const int target = examples[i].category == names[c] ? 1 : -1;
      targets(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(c)) = trained[i] ? target : 0;
    }
  }
  const RidgeFit fit = FitRidge(kernel, targets, groups, BalancedPenalties(examples, trained));
  Confusions confusions;
  for (std::size_t i = 0; i < examples.size(); ++i) {
    if (!examples[i].used_for_calibration || examples[i].mirrored) continue;
    Eigen::Index best = 0;
    fit.held_out.row(static_cast<Eigen::Index>(i)).maxCoeff(&best);
    const std::string& label = names[static_cast<std::size_t>(best)];
    if (label != examples[i].category) ++confusions[std::minmax(label, examples[i].category)];
  }
  return confusions;
}

// Returns the chiral categories, i.e. pairs that are mirror images of each other: mirrored examples increase their
// confusions significantly (2 sigma).
std::set<std::string> FindChiralCategories(const Eigen::MatrixXd& kernel, std::span<const CategoryExample> examples,
                                           const Trained& trained) {
  std::set<std::string> chiral;
  if (std::ranges::none_of(examples, &CategoryExample::mirrored)) return chiral;
  std::set<std::string> categories;
  for (std::size_t i = 0; i < examples.size(); ++i)
    if (trained[i]) categories.insert(examples[i].category);
  const Confusions with = CountConfusions(kernel, examples, trained, categories);
  Confusions without = CountConfusions(kernel, examples, WithoutMirrored(examples, trained, categories), categories);
  for (const auto& [pair, count] : with) {
    constexpr double kSigmas = 2;  // standard deviations of the difference of two counts
    const int before = without[pair];
    if (count - before <= kSigmas * std::sqrt(count + before)) continue;
    chiral.insert(pair.first);
    chiral.insert(pair.second);
  }
  return chiral;
}

// Removes shape examples whose weights are zero for all nodes.
void RemoveUnusedShapes(LinearModel& model) {
  std::vector<Eigen::Index> used;
  for (Eigen::Index i = 0; i < model.shape_examples.cols(); ++i) {
    const auto is_used = [&](const LinearWeights& weights) { return weights.shapes(i) != 0; };
    if (std::ranges::any_of(model.word_weights, is_used) || std::ranges::any_of(model.phrase_weights, is_used))
      used.push_back(i);
  }
  model.shape_examples = Eigen::MatrixXf(model.shape_examples(Eigen::all, used));
  for (std::vector<LinearWeights>* of_all : {&model.word_weights, &model.phrase_weights})
    for (LinearWeights& weights : *of_all) weights.shapes = Eigen::VectorXf(weights.shapes(used));
}

}  // namespace

LinearFit TrainLinear(std::span<const CategoryExample> examples, std::vector<CategoryNode> nodes,
                      const Vocabulary& vocabulary, const VocabularyOptions& words, const LinearOptions& options,
                      std::uint64_t seed) {
  LinearModel model;
  const std::vector<const FeatureSet*> sets = TrainingFeatures(examples);
  model.fisher = FisherEncoder::Learn(sets, options.fisher, seed);
  model.shape = ShapeEncoder::Learn(sets, options.shapes);
  ClusterWords(vocabulary, words, options.phrases.word_clusters, seed, model);
  const TrainingData data =
      ComputeTrainingData(model, QuantiseExamples(examples, model, vocabulary, words.words_per_keypoint));
  const double phrase_weight = options.phrases.weight;
  const double fisher_weight = options.fisher.weight;
  const double shape_weight = options.shapes.weight;
  const std::size_t phrases = PhraseCount(model.word_clusters);
  Eigen::MatrixXd word_kernel = KernelMatrix(data.words, vocabulary.size()).array() + 1.0;
  if (shape_weight > 0) {
    model.shape_examples = data.shapes;
    word_kernel += shape_weight * CompareShapes(data.shapes, data.shapes).cast<double>();
  }
  const Eigen::MatrixXd joint_kernel =
      word_kernel + phrase_weight * KernelMatrix(data.phrases, phrases) + fisher_weight * KernelMatrix(data.fisher);
  Trained trained;
  for (const CategoryExample& example : examples) trained.push_back(example.used_for_training);
  trained = WithoutMirrored(examples, trained, FindChiralCategories(joint_kernel, examples, trained));
  const NodeFits by_words = FitNodes(word_kernel, examples, trained, nodes);
  const NodeFits by_phrases = FitNodes(joint_kernel, examples, trained, nodes);
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    const auto weights = [&](const NodeFits& fits) {
      const Eigen::VectorXd alpha = fits.alpha.col(static_cast<Eigen::Index>(n));
      return LinearWeights{.words = PrimalWeights(data.words, alpha, vocabulary.size()),
                           .phrases = {},
                           .fisher = {},
                           .shapes = (shape_weight * alpha.head(model.shape_examples.cols())).cast<float>(),
                           .offset = static_cast<float>(alpha.sum())};
    };
    nodes[n].words = by_words.calibrations[n];
    nodes[n].phrases = by_phrases.calibrations[n];
    model.word_weights.push_back(weights(by_words));
    const Eigen::VectorXd alpha = by_phrases.alpha.col(static_cast<Eigen::Index>(n));
    LinearWeights joint = weights(by_phrases);
    joint.phrases = PrimalWeights(data.phrases, phrase_weight * alpha, phrases);
    joint.fisher = data.fisher * (fisher_weight * alpha).cast<float>();
    model.phrase_weights.push_back(std::move(joint));
  }
  RemoveUnusedShapes(model);
  return {.model = std::move(model), .nodes = std::move(nodes)};
}

}  // namespace victorious

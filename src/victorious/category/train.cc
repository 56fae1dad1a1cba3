#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>
#include <opencv2/core/utility.hpp>

#include "victorious/base/check.h"
#include "victorious/base/random.h"
#include "victorious/base/version.h"
#include "victorious/category/category_model.h"
#include "victorious/category/common/held_out.h"
#include "victorious/category/thesis/likelihood.h"

namespace victorious {
namespace {

Status CheckName(const std::string& name) {
  const bool has_empty_part =
      name.empty() || name.front() == '/' || name.back() == '/' || name.find("//") != std::string::npos;
  if (!has_empty_part) return {};
  return Fail(ErrorCode::kInvalidArgument,
              fmt::format("category \"{}\": must be a name, or names from general to specific separated by single "
                          "slashes, as in vehicle/car",
                          name));
}

Status CheckExamples(std::span<const CategoryExample> examples) {
  struct TrainingData {
    std::set<int> pictures;
    std::size_t features = 0;
  };
  std::map<std::string, TrainingData> categories;
  for (const CategoryExample& example : examples) {
    VICTORIOUS_RETURN_IF_ERROR(CheckName(example.category));
    if (!example.used_for_training) continue;
    TrainingData& training_data = categories[example.category];
    training_data.pictures.insert(example.picture);
    training_data.features += example.features.size();
  }
  if (categories.size() < 2) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{}; at least two are needed; the second may be a background category of arbitrary other "
                            "images",
                            categories.empty() ? "no categories" : "one category"));
  }
  for (const auto& [name, training_data] : categories) {
    if (training_data.pictures.size() < 2)
      return Fail(ErrorCode::kInvalidArgument, fmt::format("category {}: one picture; at least two are needed", name));
    if (training_data.features == 0)
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("category {}: no features in any of its {} images; larger or sharper images are needed",
                              name, training_data.pictures.size()));
  }
  return {};
}

std::vector<CategoryNode> MakeNodes(std::span<const CategoryExample> examples) {
  std::map<std::string, bool> can_be_label;
  for (const CategoryExample& example : examples) {
    can_be_label[example.category] = true;
    for (std::size_t slash = example.category.find('/'); slash != std::string::npos;
         slash = example.category.find('/', slash + 1))
      can_be_label.try_emplace(example.category.substr(0, slash), false);
  }
  std::vector<CategoryNode> nodes;
  for (const auto& [name, is_label] : can_be_label) nodes.push_back({.name = name, .can_be_label = is_label});
  return nodes;
}

std::vector<const FeatureSet*> TrainingFeatures(std::span<const CategoryExample> examples) {
  std::vector<const FeatureSet*> sets;
  for (const CategoryExample& example : examples)
    if (example.used_for_training) sets.push_back(&example.features);
  return sets;
}

std::vector<QuantisedImage> QuantiseExamples(std::span<const CategoryExample> examples, const CategoryModel& model) {
  std::vector<QuantisedImage> pictures(examples.size());
  cv::parallel_for_({0, static_cast<int>(examples.size())}, [&](const cv::Range& range) {
    for (int i = range.start; i < range.end; ++i)
      pictures[static_cast<std::size_t>(i)] = QuantiseFeatures(model, examples[static_cast<std::size_t>(i)].features);
  });
  return pictures;
}

// Clusters the words by k-means on their centres.
void ClusterWords(CategoryModel& model) {
  VocabularyOptions options = model.options.vocabulary;
  options.words = model.options.phrases.word_clusters;
  options.root = false;  // the centres are already square-rooted
  const Vocabulary word_clusters = Vocabulary::Learn(model.vocabulary.centres(), options, model.options.seed);
  model.word_clusters = word_clusters.size();
  for (const kernels::Neighbour& part : word_clusters.NearestWords(model.vocabulary.centres(), 1))
    model.cluster_of_word.push_back(static_cast<std::uint16_t>(part.index));
}

// Input of the linear classifier for a set of images.
struct TrainingData {
  std::vector<SparseVector> words;
  std::vector<SparseVector> phrases;
  Eigen::MatrixXf fisher;  // one column per image
  Eigen::MatrixXf shapes;  // one column per image
};

TrainingData ComputeTrainingData(const CategoryModel& model, std::span<const QuantisedImage> pictures) {
  TrainingData training_data{
      .words = std::vector<SparseVector>(pictures.size()),
      .phrases = std::vector<SparseVector>(pictures.size()),
      .fisher = {static_cast<Eigen::Index>(model.fisher.size()), static_cast<Eigen::Index>(pictures.size())},
      .shapes = {static_cast<Eigen::Index>(model.shape.size()), static_cast<Eigen::Index>(pictures.size())}};
  cv::parallel_for_({0, static_cast<int>(pictures.size())}, [&](const cv::Range& range) {
    for (int i = range.start; i < range.end; ++i) {
      const auto at = static_cast<std::size_t>(i);
      const auto phrases = FindPhrases(pictures[at], model.cluster_of_word, model.word_clusters, model.options.phrases);
      training_data.words[at] = Hellinger(CountWords(pictures[at], model.vocabulary.size()));
      training_data.phrases[at] = Hellinger(CountPhrases(phrases, model.word_clusters));
      training_data.fisher.col(i) = pictures[at].fisher;
      training_data.shapes.col(i) = pictures[at].shape;
    }
  });
  return training_data;
}

// Kernel matrix of sparse vectors.
// @param size  dimension of the vectors
Eigen::MatrixXd KernelMatrix(std::span<const SparseVector> vectors, std::size_t size) {
  const auto count = static_cast<Eigen::Index>(vectors.size());
  Eigen::MatrixXd kernel(count, count);
  cv::parallel_for_({0, static_cast<int>(count)}, [&](const cv::Range& range) {
    std::vector<float> dense(size);
    for (Eigen::Index i = range.start; i < range.end; ++i) {
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
Eigen::VectorXf Weights(std::span<const SparseVector> vectors, const Eigen::VectorXd& alpha, std::size_t size) {
  Eigen::VectorXf weights = Eigen::VectorXf::Zero(static_cast<Eigen::Index>(size));
  for (std::size_t i = 0; i < vectors.size(); ++i)
    for (const auto& [index, value] : vectors[i])
      weights(index) += static_cast<float>(alpha(static_cast<Eigen::Index>(i)) * value);
  return weights;
}

// Penalties that give all categories equal total weight; their mean over the examples is `lambda`.
Eigen::VectorXd BalancedPenalties(std::span<const CategoryExample> examples, double lambda) {
  std::map<std::string, double> count;
  double all = 0;
  for (const CategoryExample& example : examples) {
    if (!example.used_for_training) continue;
    count[example.category] += 1;
    all += 1;
  }
  Eigen::VectorXd penalties(static_cast<Eigen::Index>(examples.size()));
  for (std::size_t i = 0; i < examples.size(); ++i) {
    const double of_category = count.contains(examples[i].category) ? count[examples[i].category] : 1;
    penalties(static_cast<Eigen::Index>(i)) = lambda * of_category * static_cast<double>(count.size()) / all;
  }
  return penalties;
}

// Dual weights and calibrations of all nodes for one method. Nodes with the same training examples share a
// factorisation.
struct NodeFits {
  Eigen::MatrixXd alpha;  // one column per node
  std::vector<Calibration> calibrations;
};

NodeFits FitNodes(const Eigen::MatrixXd& kernel, std::span<const CategoryExample> examples,
                  const CategoryModel& model) {
  std::vector<int> groups;
  for (const CategoryExample& example : examples) groups.push_back(example.picture);
  const Eigen::VectorXd penalties = BalancedPenalties(examples, model.options.lambda);
  const auto rows = static_cast<Eigen::Index>(examples.size());
  std::map<std::vector<bool>, std::vector<Eigen::Index>> nodes_by_examples;  // by their training examples
  Eigen::MatrixXi targets(rows, static_cast<Eigen::Index>(model.nodes.size()));
  for (Eigen::Index n = 0; n < targets.cols(); ++n) {
    std::vector<bool> used_for_training;
    for (std::size_t i = 0; i < examples.size(); ++i) {
      const int target = TrainingTarget(examples[i].category, model.nodes[static_cast<std::size_t>(n)].name);
      targets(static_cast<Eigen::Index>(i), n) = target;
      used_for_training.push_back(examples[i].used_for_training && target != 0);
    }
    nodes_by_examples[used_for_training].push_back(n);
  }
  NodeFits fits{.alpha = {rows, targets.cols()}, .calibrations = std::vector<Calibration>(model.nodes.size())};
  for (const auto& [used_for_training, nodes] : nodes_by_examples) {
    Eigen::MatrixXi learned = targets(Eigen::all, nodes);
    for (Eigen::Index i = 0; i < rows; ++i)
      if (!used_for_training[static_cast<std::size_t>(i)]) learned.row(i).setZero();
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

// Copies the examples without their features.
std::vector<CategoryExample> WithoutFeatures(std::span<const CategoryExample> examples) {
  std::vector<CategoryExample> stripped_examples;
  for (const CategoryExample& example : examples) {
    stripped_examples.push_back({.category = example.category,
                                 .features = {},
                                 .picture = example.picture,
                                 .used_for_training = example.used_for_training,
                                 .used_for_calibration = example.used_for_calibration,
                                 .mirrored = example.mirrored});
  }
  return stripped_examples;
}

void ExcludeMirrored(const std::set<std::string>& categories, std::vector<CategoryExample>& stripped_examples) {
  for (CategoryExample& example : stripped_examples)
    example.used_for_training =
        example.used_for_training && !(example.mirrored && categories.contains(example.category));
}

// Number of confusions for each pair of categories, by held-out scores.
using Confusions = std::map<std::pair<std::string, std::string>, int>;

Confusions CountConfusions(const Eigen::MatrixXd& kernel, std::span<const CategoryExample> stripped_examples,
                           const std::set<std::string>& categories, double lambda) {
  const std::vector<std::string> names(categories.begin(), categories.end());
  std::vector<int> groups;
  Eigen::MatrixXi targets(static_cast<Eigen::Index>(stripped_examples.size()), static_cast<Eigen::Index>(names.size()));
  for (std::size_t i = 0; i < stripped_examples.size(); ++i) {
    groups.push_back(stripped_examples[i].picture);
    for (std::size_t c = 0; c < names.size(); ++c) {
      const int target = stripped_examples[i].category == names[c] ? 1 : -1;
      targets(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(c)) =
          stripped_examples[i].used_for_training ? target : 0;
    }
  }
  const RidgeFit fit = FitRidge(kernel, targets, groups, BalancedPenalties(stripped_examples, lambda));
  Confusions confusions;
  for (std::size_t i = 0; i < stripped_examples.size(); ++i) {
    if (!stripped_examples[i].used_for_calibration || stripped_examples[i].mirrored) continue;
    Eigen::Index best = 0;
    fit.held_out.row(static_cast<Eigen::Index>(i)).maxCoeff(&best);
    const std::string& label = names[static_cast<std::size_t>(best)];
    if (label != stripped_examples[i].category) ++confusions[std::minmax(label, stripped_examples[i].category)];
  }
  return confusions;
}

// Returns the chiral categories, i.e. pairs that are mirror images of each other: mirrored examples increase their
// confusions significantly (2 sigma).
std::set<std::string> FindChiralCategories(const Eigen::MatrixXd& kernel, std::span<const CategoryExample> examples,
                                           double lambda) {
  std::set<std::string> chiral;
  if (std::ranges::none_of(examples, &CategoryExample::mirrored)) return chiral;
  std::vector<CategoryExample> stripped_examples = WithoutFeatures(examples);
  std::set<std::string> categories;
  for (const CategoryExample& example : stripped_examples)
    if (example.used_for_training) categories.insert(example.category);
  const Confusions with = CountConfusions(kernel, stripped_examples, categories, lambda);
  ExcludeMirrored(categories, stripped_examples);
  Confusions without = CountConfusions(kernel, stripped_examples, categories, lambda);
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
void RemoveUnusedShapes(CategoryModel& model) {
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

void LearnLinear(std::span<const CategoryExample> examples, std::span<const QuantisedImage> pictures,
                 CategoryModel& model) {
  ClusterWords(model);
  const TrainingData training_data = ComputeTrainingData(model, pictures);
  const double phrase_weight = model.options.phrases.weight;
  const double fisher_weight = model.options.fisher.weight;
  const std::size_t phrases = PhraseCount(model.word_clusters);
  const double shape_weight = model.options.shapes.weight;
  Eigen::MatrixXd word_kernel = KernelMatrix(training_data.words, model.vocabulary.size()).array() + 1.0;
  if (shape_weight > 0) {
    model.shape_examples = training_data.shapes;
    word_kernel +=
        shape_weight *
        CompareShapes(training_data.shapes, training_data.shapes, model.options.shapes.sharpness).cast<double>();
  }
  const Eigen::MatrixXd joint_kernel = word_kernel + phrase_weight * KernelMatrix(training_data.phrases, phrases) +
                                       fisher_weight * KernelMatrix(training_data.fisher);
  std::vector<CategoryExample> stripped_examples = WithoutFeatures(examples);
  ExcludeMirrored(FindChiralCategories(joint_kernel, examples, model.options.lambda), stripped_examples);
  const NodeFits by_words = FitNodes(word_kernel, stripped_examples, model);
  const NodeFits by_phrases = FitNodes(joint_kernel, stripped_examples, model);
  for (std::size_t n = 0; n < model.nodes.size(); ++n) {
    const auto weights = [&](const NodeFits& fits) {
      const Eigen::VectorXd alpha = fits.alpha.col(static_cast<Eigen::Index>(n));
      return LinearWeights{.words = Weights(training_data.words, alpha, model.vocabulary.size()),
                           .phrases = {},
                           .fisher = {},
                           .shapes = (shape_weight * alpha.head(model.shape_examples.cols())).cast<float>(),
                           .offset = static_cast<float>(alpha.sum())};
    };
    model.nodes[n].words = by_words.calibrations[n];
    model.nodes[n].phrases = by_phrases.calibrations[n];
    model.word_weights.push_back(weights(by_words));
    const Eigen::VectorXd alpha = by_phrases.alpha.col(static_cast<Eigen::Index>(n));
    LinearWeights joint = weights(by_phrases);
    joint.phrases = Weights(training_data.phrases, phrase_weight * alpha, phrases);
    joint.fisher = training_data.fisher * (fisher_weight * alpha).cast<float>();
    model.phrase_weights.push_back(std::move(joint));
  }
  RemoveUnusedShapes(model);
}

}  // namespace

Expected<CategoryModel> TrainCategories(std::span<const CategoryExample> examples, const CategoryOptions& options) {
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
  VICTORIOUS_RETURN_IF_ERROR(CheckExamples(examples));
  CategoryModel model;
  model.program_version = kVersion;
  model.options = options;
  model.nodes = MakeNodes(examples);
  const std::vector<const FeatureSet*> sets = TrainingFeatures(examples);
  model.vocabulary = Vocabulary::Learn(sets, options.vocabulary, options.seed);
  if (options.scoring == "linear") {
    model.fisher = FisherEncoder::Learn(sets, options.fisher, options.seed);
    model.shape = ShapeEncoder::Learn(sets, options.shapes);
    LearnLinear(examples, QuantiseExamples(examples, model), model);
  } else {
    LearnLikelihoods(examples, model);
  }
  return model;
}

}  // namespace victorious

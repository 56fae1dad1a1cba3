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
#include "victorious/category/held_out.h"
#include "victorious/category/likelihood.h"

namespace victorious {
namespace {

Status CheckName(const std::string& name) {
  const bool has_empty_part =
      name.empty() || name.front() == '/' || name.back() == '/' || name.find("//") != std::string::npos;
  if (!has_empty_part) return {};
  return Fail(
      ErrorCode::kInvalidArgument,
      fmt::format("category \"{}\": must be a name, or names from general to specific separated by single "
                  "slashes, as in vehicle/car",
                  name));
}

Status CheckExamples(std::span<const CategoryExample> examples) {
  struct Seen {
    std::set<int> pictures;
    std::size_t features = 0;
  };
  std::map<std::string, Seen> categories;
  for (const CategoryExample& example : examples) {
    VICTORIOUS_RETURN_IF_ERROR(CheckName(example.category));
    if (!example.learns) continue;
    Seen& seen = categories[example.category];
    seen.pictures.insert(example.picture);
    seen.features += example.features.size();
  }
  if (categories.size() < 2) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{}; at least two are needed; the second may be a background category of arbitrary other "
                            "images",
                            categories.empty() ? "no categories" : "one category"));
  }
  for (const auto& [name, seen] : categories) {
    if (seen.pictures.size() < 2)
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("category {}: one picture; at least two are needed", name));
    if (seen.features == 0)
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("category {}: no features in any of its {} images; larger or sharper images are needed",
                              name, seen.pictures.size()));
  }
  return {};
}

std::vector<CategoryNode> NodesOf(std::span<const CategoryExample> examples) {
  std::map<std::string, bool> labels;
  for (const CategoryExample& example : examples) {
    labels[example.category] = true;
    for (std::size_t slash = example.category.find('/'); slash != std::string::npos;
         slash = example.category.find('/', slash + 1))
      labels.try_emplace(example.category.substr(0, slash), false);
  }
  std::vector<CategoryNode> nodes;
  for (const auto& [name, is_label] : labels) nodes.push_back({.name = name, .labels = is_label});
  return nodes;
}

std::vector<const FeatureSet*> LearnedSets(std::span<const CategoryExample> examples) {
  std::vector<const FeatureSet*> sets;
  for (const CategoryExample& example : examples)
    if (example.learns) sets.push_back(&example.features);
  return sets;
}

std::vector<WordedPicture> PicturesOf(std::span<const CategoryExample> examples, const CategoryModel& model) {
  std::vector<WordedPicture> pictures(examples.size());
  cv::parallel_for_({0, static_cast<int>(examples.size())}, [&](const cv::Range& range) {
    for (int i = range.start; i < range.end; ++i)
      pictures[static_cast<std::size_t>(i)] = WordsOf(model, examples[static_cast<std::size_t>(i)].features);
  });
  return pictures;
}

// Clusters the words by k-means on their centres.
void LearnParts(CategoryModel& model) {
  VocabularyOptions options = model.options.vocabulary;
  options.words = model.options.phrases.parts;
  options.root = false;  // the centres are already square-rooted
  const Vocabulary parts = Vocabulary::Learn(model.vocabulary.centres(), options, model.options.seed);
  model.parts = parts.size();
  for (const kernels::Neighbour& part : parts.NearestWords(model.vocabulary.centres(), 1))
    model.part_of_word.push_back(static_cast<std::uint16_t>(part.index));
}

// Input of the linear classifier for a set of images.
struct Seen {
  std::vector<SparseVector> words;
  std::vector<SparseVector> phrases;
  Eigen::MatrixXf fisher;  // one column per image
  Eigen::MatrixXf shapes;  // one column per image
};

Seen See(const CategoryModel& model, std::span<const WordedPicture> pictures) {
  Seen seen{.words = std::vector<SparseVector>(pictures.size()),
            .phrases = std::vector<SparseVector>(pictures.size()),
            .fisher = {static_cast<Eigen::Index>(model.fisher.size()), static_cast<Eigen::Index>(pictures.size())},
            .shapes = {static_cast<Eigen::Index>(model.shape.size()), static_cast<Eigen::Index>(pictures.size())}};
  cv::parallel_for_({0, static_cast<int>(pictures.size())}, [&](const cv::Range& range) {
    for (int i = range.start; i < range.end; ++i) {
      const auto at = static_cast<std::size_t>(i);
      const auto phrases = FindPhrases(pictures[at], model.part_of_word, model.parts, model.options.phrases);
      seen.words[at] = Hellinger(CountWords(pictures[at], model.vocabulary.size()));
      seen.phrases[at] = Hellinger(CountPhrases(phrases, model.parts));
      seen.fisher.col(i) = pictures[at].fisher;
      seen.shapes.col(i) = pictures[at].shape;
    }
  });
  return seen;
}

// Kernel matrix of sparse vectors.
// @param size  dimension of the vectors
Eigen::MatrixXd KernelOf(std::span<const SparseVector> vectors, std::size_t size) {
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

Eigen::MatrixXd KernelOf(const Eigen::MatrixXf& columns) {
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
Eigen::VectorXd PenaltiesOf(std::span<const CategoryExample> examples, double lambda) {
  std::map<std::string, double> count;
  double all = 0;
  for (const CategoryExample& example : examples) {
    if (!example.learns) continue;
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
  const Eigen::VectorXd penalties = PenaltiesOf(examples, model.options.lambda);
  const auto rows = static_cast<Eigen::Index>(examples.size());
  std::map<std::vector<bool>, std::vector<Eigen::Index>> nodes_of;  // by their training examples
  Eigen::MatrixXi targets(rows, static_cast<Eigen::Index>(model.nodes.size()));
  for (Eigen::Index n = 0; n < targets.cols(); ++n) {
    std::vector<bool> learns;
    for (std::size_t i = 0; i < examples.size(); ++i) {
      const int target = TargetOf(examples[i].category, model.nodes[static_cast<std::size_t>(n)].name);
      targets(static_cast<Eigen::Index>(i), n) = target;
      learns.push_back(examples[i].learns && target != 0);
    }
    nodes_of[learns].push_back(n);
  }
  NodeFits fits{.alpha = {rows, targets.cols()}, .calibrations = std::vector<Calibration>(model.nodes.size())};
  for (const auto& [learns, nodes] : nodes_of) {
    Eigen::MatrixXi learned = targets(Eigen::all, nodes);
    for (Eigen::Index i = 0; i < rows; ++i)
      if (!learns[static_cast<std::size_t>(i)]) learned.row(i).setZero();
    const RidgeFit fit = FitRidge(kernel, learned, groups, penalties);
    fits.alpha(Eigen::all, nodes) = fit.alpha;
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      const Eigen::VectorXi column = targets.col(nodes[k]);
      fits.calibrations[static_cast<std::size_t>(nodes[k])] =
          CalibrateOn(examples, {column.data(), examples.size()}, fit.held_out.col(static_cast<Eigen::Index>(k)));
    }
  }
  return fits;
}

// Copies the examples without their features.
std::vector<CategoryExample> RolesOf(std::span<const CategoryExample> examples) {
  std::vector<CategoryExample> roles;
  for (const CategoryExample& example : examples) {
    roles.push_back({.category = example.category,
                     .features = {},
                     .picture = example.picture,
                     .learns = example.learns,
                     .calibrates = example.calibrates,
                     .mirrored = example.mirrored});
  }
  return roles;
}

void ForgetMirrored(const std::set<std::string>& categories, std::vector<CategoryExample>& roles) {
  for (CategoryExample& role : roles)
    role.learns = role.learns && !(role.mirrored && categories.contains(role.category));
}

// Number of confusions for each pair of categories, by held-out scores.
using Confusions = std::map<std::pair<std::string, std::string>, int>;

Confusions ConfusionsOf(const Eigen::MatrixXd& kernel, std::span<const CategoryExample> roles,
                        const std::set<std::string>& categories, double lambda) {
  const std::vector<std::string> names(categories.begin(), categories.end());
  std::vector<int> groups;
  Eigen::MatrixXi targets(static_cast<Eigen::Index>(roles.size()), static_cast<Eigen::Index>(names.size()));
  for (std::size_t i = 0; i < roles.size(); ++i) {
    groups.push_back(roles[i].picture);
    for (std::size_t c = 0; c < names.size(); ++c) {
      const int target = roles[i].category == names[c] ? 1 : -1;
      targets(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(c)) = roles[i].learns ? target : 0;
    }
  }
  const RidgeFit fit = FitRidge(kernel, targets, groups, PenaltiesOf(roles, lambda));
  Confusions confusions;
  for (std::size_t i = 0; i < roles.size(); ++i) {
    if (!roles[i].calibrates || roles[i].mirrored) continue;
    Eigen::Index best = 0;
    fit.held_out.row(static_cast<Eigen::Index>(i)).maxCoeff(&best);
    const std::string& label = names[static_cast<std::size_t>(best)];
    if (label != roles[i].category) ++confusions[std::minmax(label, roles[i].category)];
  }
  return confusions;
}

// Returns the chiral categories, i.e. pairs that are mirror images of each other: mirrored examples increase their
// confusions significantly (2 sigma).
std::set<std::string> MirrorImagesOfEachOther(const Eigen::MatrixXd& kernel, std::span<const CategoryExample> examples,
                                              double lambda) {
  std::set<std::string> handed;
  if (std::ranges::none_of(examples, &CategoryExample::mirrored)) return handed;
  std::vector<CategoryExample> roles = RolesOf(examples);
  std::set<std::string> categories;
  for (const CategoryExample& role : roles)
    if (role.learns) categories.insert(role.category);
  const Confusions with = ConfusionsOf(kernel, roles, categories, lambda);
  ForgetMirrored(categories, roles);
  Confusions without = ConfusionsOf(kernel, roles, categories, lambda);
  for (const auto& [pair, count] : with) {
    constexpr double kSigmas = 2;  // standard deviations of the difference of two counts
    const int before = without[pair];
    if (count - before <= kSigmas * std::sqrt(count + before)) continue;
    handed.insert(pair.first);
    handed.insert(pair.second);
  }
  return handed;
}

// Removes shape examples whose weights are zero for all nodes.
void ForgetUnusedShapes(CategoryModel& model) {
  std::vector<Eigen::Index> used;
  for (Eigen::Index i = 0; i < model.shape_examples.cols(); ++i) {
    const auto weighs = [&](const LinearWeights& weights) { return weights.shapes(i) != 0; };
    if (std::ranges::any_of(model.word_weights, weighs) || std::ranges::any_of(model.phrase_weights, weighs))
      used.push_back(i);
  }
  model.shape_examples = Eigen::MatrixXf(model.shape_examples(Eigen::all, used));
  for (std::vector<LinearWeights>* of_all : {&model.word_weights, &model.phrase_weights})
    for (LinearWeights& weights : *of_all) weights.shapes = Eigen::VectorXf(weights.shapes(used));
}

void LearnLinear(std::span<const CategoryExample> examples, std::span<const WordedPicture> pictures,
                 CategoryModel& model) {
  LearnParts(model);
  const Seen seen = See(model, pictures);
  const double phrase_weight = model.options.phrases.weight;
  const double fisher_weight = model.options.fisher.weight;
  const std::size_t phrases = PhraseCount(model.parts);
  const double shape_weight = model.options.shapes.weight;
  Eigen::MatrixXd word_kernel = KernelOf(seen.words, model.vocabulary.size()).array() + 1.0;
  if (shape_weight > 0) {
    model.shape_examples = seen.shapes;
    word_kernel +=
        shape_weight * CompareShapes(seen.shapes, seen.shapes, model.options.shapes.sharpness).cast<double>();
  }
  const Eigen::MatrixXd joint_kernel =
      word_kernel + phrase_weight * KernelOf(seen.phrases, phrases) + fisher_weight * KernelOf(seen.fisher);
  std::vector<CategoryExample> roles = RolesOf(examples);
  ForgetMirrored(MirrorImagesOfEachOther(joint_kernel, examples, model.options.lambda), roles);
  const NodeFits by_words = FitNodes(word_kernel, roles, model);
  const NodeFits by_phrases = FitNodes(joint_kernel, roles, model);
  for (std::size_t n = 0; n < model.nodes.size(); ++n) {
    const auto weights = [&](const NodeFits& fits) {
      const Eigen::VectorXd alpha = fits.alpha.col(static_cast<Eigen::Index>(n));
      return LinearWeights{.words = Weights(seen.words, alpha, model.vocabulary.size()),
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
    joint.phrases = Weights(seen.phrases, phrase_weight * alpha, phrases);
    joint.fisher = seen.fisher * (fisher_weight * alpha).cast<float>();
    model.phrase_weights.push_back(std::move(joint));
  }
  ForgetUnusedShapes(model);
}

}  // namespace

Expected<CategoryModel> TrainCategories(std::span<const CategoryExample> examples, const CategoryOptions& options) {
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
  VICTORIOUS_RETURN_IF_ERROR(CheckExamples(examples));
  CategoryModel model;
  model.program_version = kVersion;
  model.options = options;
  model.nodes = NodesOf(examples);
  const std::vector<const FeatureSet*> sets = LearnedSets(examples);
  model.vocabulary = Vocabulary::Learn(sets, options.vocabulary, options.seed);
  if (options.scoring == "linear") {
    model.fisher = FisherEncoder::Learn(sets, options.fisher, options.seed);
    model.shape = ShapeEncoder::Learn(sets, options.shapes);
    LearnLinear(examples, PicturesOf(examples, model), model);
  } else {
    LearnLikelihoods(examples, model);
  }
  return model;
}

}  // namespace victorious

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
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
      fmt::format("category \"{}\": must be a name, or names from the general to the special with one / between "
                  "them, as in vehicle/car",
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
                fmt::format("{}; at least two are needed, to tell one from the other: a background class of any other "
                            "pictures will do",
                            categories.empty() ? "no categories" : "one category"));
  }
  for (const auto& [name, seen] : categories) {
    if (seen.pictures.size() < 2)
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("category {}: one picture; at least two are needed to learn what they share", name));
    if (seen.features == 0)
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("category {}: no features in any of its {} pictures; larger or sharper ones are needed",
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

Vocabulary LearnVocabulary(std::span<const CategoryExample> examples, const CategoryOptions& options) {
  std::vector<std::uint8_t> descriptors;
  for (const CategoryExample& example : examples) {
    if (!example.learns) continue;
    descriptors.insert(descriptors.end(), example.features.descriptors.begin(), example.features.descriptors.end());
  }
  return Vocabulary::Learn(descriptors, options.vocabulary, options.seed);
}

// Words that look alike, grouped.
void LearnParts(CategoryModel& model) {
  VocabularyOptions options = model.options.vocabulary;
  options.words = model.options.phrases.parts;
  options.root = false;  // the words are compared as they are
  const Vocabulary parts = Vocabulary::Learn(model.vocabulary.centres(), options, model.options.seed);
  model.parts = parts.size();
  for (const kernels::Neighbour& part : parts.NearestWords(model.vocabulary.centres(), 1))
    model.part_of_word.push_back(static_cast<std::uint16_t>(part.index));
}

struct Histograms {
  SparseVector words;
  SparseVector phrases;
};

std::vector<Histograms> HistogramsOf(const CategoryModel& model, std::span<const WordedPicture> pictures) {
  std::vector<Histograms> histograms(pictures.size());
  cv::parallel_for_({0, static_cast<int>(pictures.size())}, [&](const cv::Range& range) {
    for (int i = range.start; i < range.end; ++i) {
      const WordedPicture& picture = pictures[static_cast<std::size_t>(i)];
      const auto phrases = FindPhrases(picture, model.part_of_word, model.parts, model.options.phrases);
      histograms[static_cast<std::size_t>(i)] = {Hellinger(CountWords(picture, model.vocabulary.size())),
                                                 Hellinger(CountPhrases(phrases, model.parts))};
    }
  });
  return histograms;
}

Eigen::MatrixXd KernelOf(std::span<const Histograms> histograms, SparseVector Histograms::* part) {
  const auto count = static_cast<Eigen::Index>(histograms.size());
  Eigen::MatrixXd kernel(count, count);
  cv::parallel_for_({0, static_cast<int>(count)}, [&](const cv::Range& range) {
    for (Eigen::Index i = range.start; i < range.end; ++i)
      for (Eigen::Index j = 0; j <= i; ++j)
        kernel(i, j) = kernel(j, i) =
            Dot(histograms[static_cast<std::size_t>(i)].*part, histograms[static_cast<std::size_t>(j)].*part);
  });
  return kernel;
}

// Sum over the examples of alpha times the histogram.
Eigen::VectorXf Weights(std::span<const Histograms> histograms, SparseVector Histograms::* part,
                        const Eigen::VectorXd& alpha, double factor, std::size_t size) {
  Eigen::VectorXf weights = Eigen::VectorXf::Zero(static_cast<Eigen::Index>(size));
  for (std::size_t i = 0; i < histograms.size(); ++i)
    for (const auto& [index, value] : histograms[i].*part)
      weights(index) += static_cast<float>(factor * alpha(static_cast<Eigen::Index>(i)) * value);
  return weights;
}

// A node that all examples show needs no weights: its calibration makes it certain.
RidgeFit Fit(const Eigen::MatrixXd& kernel, std::span<const int> targets, std::span<const int> groups, double lambda) {
  if (std::ranges::count(targets, -1) > 0) return FitRidge(kernel, targets, groups, lambda);
  return {.alpha = Eigen::VectorXd::Zero(kernel.rows()), .held_out = Eigen::VectorXd::Zero(kernel.rows())};
}

void LearnLinear(std::span<const CategoryExample> examples, std::span<const WordedPicture> pictures,
                 CategoryModel& model) {
  LearnParts(model);
  const std::vector<Histograms> histograms = HistogramsOf(model, pictures);
  const Eigen::MatrixXd word_kernel = KernelOf(histograms, &Histograms::words).array() + 1.0;
  const double phrase_weight = model.options.phrases.weight;
  const Eigen::MatrixXd joint_kernel = word_kernel + phrase_weight * KernelOf(histograms, &Histograms::phrases);
  std::vector<int> groups;
  for (const CategoryExample& example : examples) groups.push_back(example.picture);

  model.word_weights.resize(model.nodes.size());
  model.phrase_weights.resize(model.nodes.size());
  cv::parallel_for_({0, static_cast<int>(model.nodes.size())}, [&](const cv::Range& range) {
    for (auto n = static_cast<std::size_t>(range.start); n < static_cast<std::size_t>(range.end); ++n) {
      CategoryNode& node = model.nodes[n];
      std::vector<int> targets;
      std::vector<int> learned;
      for (const CategoryExample& example : examples) {
        targets.push_back(TargetOf(example.category, node.name));
        learned.push_back(example.learns ? targets.back() : 0);
      }
      const auto learn = [&](const Eigen::MatrixXd& kernel, double phrases, Calibration& calibration) {
        const RidgeFit fit = Fit(kernel, learned, groups, model.options.lambda);
        calibration = CalibrateOn(examples, targets, fit.held_out);
        return LinearWeights{.words = Weights(histograms, &Histograms::words, fit.alpha, 1, model.vocabulary.size()),
                             .phrases = phrases > 0 ? Weights(histograms, &Histograms::phrases, fit.alpha, phrases,
                                                              PhraseCount(model.parts))
                                                    : Eigen::VectorXf(),
                             .offset = static_cast<float>(fit.alpha.sum())};
      };
      model.word_weights[n] = learn(word_kernel, 0, node.words);
      model.phrase_weights[n] = learn(joint_kernel, phrase_weight, node.phrases);
    }
  });
}

}  // namespace

Expected<CategoryModel> TrainCategories(std::span<const CategoryExample> examples, const CategoryOptions& options) {
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
  VICTORIOUS_RETURN_IF_ERROR(CheckExamples(examples));
  CategoryModel model;
  model.program_version = kVersion;
  model.options = options;
  model.nodes = NodesOf(examples);
  model.vocabulary = LearnVocabulary(examples, options);
  std::vector<WordedPicture> pictures;
  for (const CategoryExample& example : examples) pictures.push_back(WordsOf(model, example.features));
  if (options.scoring == "linear") {
    LearnLinear(examples, pictures, model);
  } else {
    LearnLikelihoods(examples, pictures, model);
  }
  return model;
}

}  // namespace victorious

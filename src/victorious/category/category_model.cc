#include "victorious/category/category_model.h"

#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "victorious/base/check.h"
#include "victorious/base/version.h"
#include "victorious/category/linear/linear_training.h"

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
    std::set<int> images;
    std::size_t features = 0;
  };
  std::map<std::string, TrainingData> categories;
  for (const CategoryExample& example : examples) {
    VICTORIOUS_RETURN_IF_ERROR(CheckName(example.category));
    if (!example.used_for_training) continue;
    TrainingData& training_data = categories[example.category];
    training_data.images.insert(example.image);
    training_data.features += example.features.size();
  }
  if (categories.size() < 2) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{}; at least two are needed; the second may be a background category of arbitrary other "
                            "images",
                            categories.empty() ? "no categories" : "one category"));
  }
  for (const auto& [name, training_data] : categories) {
    if (training_data.images.size() < 2)
      return Fail(ErrorCode::kInvalidArgument, fmt::format("category {}: one image; at least two are needed", name));
    if (training_data.features == 0)
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("category {}: no features in any of its {} images; larger or sharper images are needed",
                              name, training_data.images.size()));
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

}  // namespace

Expected<CategoryModel> TrainCategories(std::span<const CategoryExample> examples, const CategoryOptions& options) {
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
  VICTORIOUS_RETURN_IF_ERROR(CheckExamples(examples));
  CategoryModel model;
  model.program_version = kVersion;
  model.options = options;
  model.nodes = MakeNodes(examples);
  model.vocabulary = Vocabulary::Learn(TrainingFeatures(examples), options.vocabulary, options.seed);
  if (options.scoring == CategoryScoring::kLinear) {
    LinearFit fit = TrainLinear(examples, std::move(model.nodes), model.vocabulary, options.vocabulary, options.linear,
                                options.seed);
    model.nodes = std::move(fit.nodes);
    model.classifier = std::move(fit.model);
  } else {
    ThesisFit fit = TrainThesis(examples, std::move(model.nodes), model.vocabulary, options.vocabulary, options.thesis,
                                options.seed);
    model.nodes = std::move(fit.nodes);
    model.classifier = std::move(fit.model);
  }
  return model;
}

CategoryResult Classify(const CategoryModel& model, const QuantisedImage& image, CategoryMethod method) {
  VICTORIOUS_CHECK(!model.nodes.empty());
  const LinearModel* linear = model.linear();
  const std::vector<double> raw = linear != nullptr ? LinearScores(*linear, image, method)
                                                    : ThesisScores(std::get<ThesisModel>(model.classifier), model.nodes,
                                                                   model.options.thesis, image, method);
  CategoryResult result;
  double best = -1;
  for (std::size_t n = 0; n < raw.size(); ++n) {
    const CategoryNode& node = model.nodes[n];
    result.scores.push_back({raw[n], node.CalibrationFor(method).Probability(raw[n])});
    if (node.can_be_label && result.scores[n].probability > best) {
      best = result.scores[n].probability;
      result.label = n;
    }
  }
  return result;
}

QuantisedImage QuantiseFeatures(const CategoryModel& model, const FeatureSet& features) {
  const int words_per_keypoint = model.options.vocabulary.words_per_keypoint;
  if (const LinearModel* linear = model.linear(); linear != nullptr)
    return QuantiseForLinear(*linear, features, model.vocabulary, words_per_keypoint);
  return QuantiseFeatures(features, model.vocabulary, words_per_keypoint);
}

}  // namespace victorious

#include "experiments/caltech.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>

#include "victorious/base/check.h"
#include "victorious/base/random.h"
#include "victorious/input/image/image_file.h"
#include "victorious/jobs/preset.h"

namespace victorious {
namespace {

double SecondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

bool Contains(std::span<const std::string> names, const std::string& name) {
  return names.empty() || std::ranges::find(names, name) != names.end();
}

std::filesystem::path CaltechFolder(const ExperimentSettings& settings) { return settings.data / "caltech101"; }

}  // namespace

Expected<std::vector<CategoryListRow>> ReadCaltechRows(const ExperimentSettings& settings,
                                                       std::span<const std::string> categories) {
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<CategoryListRow> rows,
                              ReadCategoryList(CaltechFolder(settings) / "list.csv"));
  std::erase_if(rows, [&](const CategoryListRow& row) { return !Contains(categories, row.category); });
  return rows;
}

Split MakeRandomSplit(std::span<const CategoryListRow> rows, std::uint64_t seed) {
  std::map<std::string, std::vector<std::size_t>> of_category;
  for (std::size_t i = 0; i < rows.size(); ++i) of_category[rows[i].category].push_back(i);
  Random random(seed);
  Split split;
  for (auto& [category, members] : of_category) {
    constexpr std::size_t kMaxTraining = 30;
    const std::size_t train_limit = std::min(kMaxTraining, members.size() / 2);
    // Images with boxes first, unless there are none.
    const auto boxed_end =
        std::stable_partition(members.begin(), members.end(), [&](std::size_t i) { return rows[i].box.has_value(); });
    auto candidates = static_cast<std::size_t>(boxed_end - members.begin());
    if (candidates == 0) candidates = members.size();
    const std::size_t count = std::min(train_limit, candidates);
    for (std::size_t i = 0; i < count; ++i)
      std::swap(members[i], members[i + random.Below(static_cast<std::uint32_t>(candidates - i))]);
    const auto middle = members.begin() + static_cast<std::ptrdiff_t>(count);
    split.train.insert(split.train.end(), members.begin(), middle);
    constexpr std::ptrdiff_t kMaxTests = 100;
    const auto left = members.end() - middle;
    const std::ptrdiff_t tests = std::min(kMaxTests, left);
    for (std::ptrdiff_t i = 0; i < tests; ++i)
      std::swap(middle[i], middle[i + random.Below(static_cast<std::uint32_t>(left - i))]);
    split.test.insert(split.test.end(), middle, middle + tests);
  }
  return split;
}

Expected<CaltechFeatures> CaltechFeatures::Load(const ExperimentSettings& settings, std::vector<CategoryListRow> rows,
                                                const CategoryFeatureOptions& options) {
  VICTORIOUS_ASSIGN_OR_RETURN(const CategoryFeaturizer featurizer, CategoryFeaturizer::Create(options));
  CaltechFeatures features;
  features.rows_ = std::move(rows);
  features.whole_.resize(features.rows_.size());
  features.examples_.resize(features.rows_.size());
  const auto extract = [&](std::size_t i, const cv::Mat& bgr) -> Status {
    VICTORIOUS_RETURN_IF_ERROR(settings.CheckCancelled());
    const CategoryListRow& row = features.rows_[i];
    const cv::Mat grey = GreyFromBgr(bgr);
    VICTORIOUS_ASSIGN_OR_RETURN(const Box box, ClippedBox(row, grey.cols, grey.rows));
    VICTORIOUS_ASSIGN_OR_RETURN(features.examples_[i],
                                victorious::ExamplesOf(featurizer, grey, box, row.category, static_cast<int>(i)));
    VICTORIOUS_ASSIGN_OR_RETURN(features.whole_[i], featurizer.Extract(grey));
    // Stores the features of a whole-image example once.
    for (CategoryExample& example : features.examples_[i])
      if (example.features.descriptors == features.whole_[i].descriptors) example.features = {};
    return {};
  };
  VICTORIOUS_RETURN_IF_ERROR(ForEachImage(CaltechFolder(settings), features.rows_, extract, [](std::size_t) {}));
  settings.progress(fmt::format("features of {} images", features.rows_.size()));
  return features;
}

std::vector<CategoryExample> CaltechFeatures::ExamplesOf(std::span<const std::size_t> rows) const {
  std::vector<CategoryExample> examples;
  for (const std::size_t row : rows) {
    for (const CategoryExample& example : examples_[row]) {
      examples.push_back(example);
      if (example.features.keypoints.empty()) examples.back().features = whole_[row];
    }
  }
  return examples;
}

Expected<TestScores> TrainAndTest(const CaltechFeatures& features, const CategoryOptions& options, std::uint64_t seed,
                                  std::span<const std::string> trained, std::span<const std::string> tested,
                                  CategoryModel* model_out) {
  Split split = MakeRandomSplit(features.rows(), seed);
  std::erase_if(split.train, [&](std::size_t i) { return !Contains(trained, features.rows()[i].category); });
  std::erase_if(split.test, [&](std::size_t i) { return !Contains(tested, features.rows()[i].category); });
  CategoryOptions seeded = options;
  seeded.seed = seed;
  TestScores scores;
  const auto start = std::chrono::steady_clock::now();
  VICTORIOUS_ASSIGN_OR_RETURN(CategoryModel model, TrainCategories(features.ExamplesOf(split.train), seeded));
  scores.train_s = SecondsSince(start);
  std::vector<QuantisedImage> images(split.test.size());
  oneapi::tbb::parallel_for(std::size_t{0}, images.size(), [&](std::size_t i) {
    images[i] = QuantiseFeatures(model, features.WholeImage(split.test[i]));
  });
  for (std::size_t i = 0; i < images.size(); ++i) {
    const auto scoring = std::chrono::steady_clock::now();
    scores.phrases.push_back(Classify(model, images[i], CategoryMethod::kPhrases));
    scores.phrase_scoring_ms += 1000 * SecondsSince(scoring) / static_cast<double>(images.size());
    scores.words.push_back(Classify(model, images[i], CategoryMethod::kWords));
    scores.truth.push_back(features.rows()[split.test[i]].category);
  }
  if (model_out != nullptr) *model_out = std::move(model);
  return scores;
}

double ComputeAccuracy(const TestScores& scores, const CategoryModel& model, CategoryMethod method,
                       const std::string& category) {
  double right = 0;
  double all = 0;
  for (std::size_t i = 0; i < scores.truth.size(); ++i) {
    if (scores.truth[i] != category) continue;
    all += 1;
    right += model.nodes[scores.ResultsBy(method)[i].label].name == category ? 1 : 0;
  }
  return all > 0 ? right / all : 0.0;
}

double MeanAccuracy(const TestScores& scores, const CategoryModel& model, CategoryMethod method) {
  std::map<std::string, double> accuracy;
  for (const std::string& category : scores.truth) accuracy.try_emplace(category, 0);
  double sum = 0;
  for (auto& [category, value] : accuracy) sum += ComputeAccuracy(scores, model, method, category);
  return sum / static_cast<double>(accuracy.size());
}

Ranking ComputeRanking(const TestScores& scores, const CategoryModel& model, CategoryMethod method,
                       const std::string& category) {
  const auto node =
      static_cast<std::size_t>(std::ranges::find(model.nodes, category, &CategoryNode::name) - model.nodes.begin());
  Ranking ranking;
  for (std::size_t i = 0; i < scores.truth.size(); ++i) {
    ranking.scores.push_back(scores.ResultsBy(method)[i].scores[node].raw);
    ranking.is_positive.push_back(scores.truth[i] == category);
  }
  return ranking;
}

CategoryTrainOptions ThesisCategories() {
  CategoryTrainOptions options;
  VICTORIOUS_CHECK(ApplyPreset(Preset::kThesis, options).has_value());
  return options;
}

CategoryTrainOptions ThesisCategoriesAsPrinted() {
  CategoryTrainOptions options = ThesisCategories();
  options.category.thesis.grammar = GrammarOptions();
  return options;
}

}  // namespace victorious

// Table 3.7: accuracy of airplanes and cars with words and phrases, by the thesis's method and by ours; and an ablation
// in steps from the former to the latter.
#include <array>
#include <map>
#include <optional>
#include <span>

#include <fmt/format.h>

#include "experiments/caltech.h"
#include "experiments/category_experiments.h"
#include "experiments/roc.h"

namespace victorious {
namespace {

struct Step {
  std::string name;
  CategoryTrainOptions options;
};

std::vector<Step> Methods() {
  return {{"thesis's method as printed", ThesisCategoriesAsPrinted()},
          {"thesis's method, words as prior, cap lowered, tempered (--params thesis)", ThesisCategories()},
          {"ours, the default", CategoryTrainOptions()}};
}

// The steps; each includes the changes of those before it.
std::vector<Step> Steps() {
  std::vector<Step> steps;
  CategoryTrainOptions options = ThesisCategoriesAsPrinted();
  const CategoryTrainOptions ours;
  const auto step = [&](const char* name) { steps.push_back({name, options}); };
  step("thesis's method as printed");
  options = ThesisCategories();
  step("words as prior, cap of equation 3.1 lowered, tempered");
  options.category.scoring = ours.category.scoring;
  step("counts with learned weights");
  options.features.surroundings = ours.features.surroundings;
  step("learned with surroundings");
  options.features.kind = ours.features.kind;
  options.category.linear.fisher.components = 0;
  step("features on a grid, at several sizes");
  options.category.vocabulary.root = ours.category.vocabulary.root;
  step("RootSIFT");
  options.category.vocabulary.words_per_keypoint = ours.category.vocabulary.words_per_keypoint;
  step("soft words");
  options.features.mirrored = ours.features.mirrored;
  step("mirror images");
  step("Fisher vectors with places: ours, the default");
  steps.back().options = ours;
  return steps;
}

constexpr std::array kMethods = {std::pair{CategoryMethod::kWords, "words"},
                                 std::pair{CategoryMethod::kPhrases, "phrases"}};

struct MethodFigures {
  std::vector<double> airplanes;
  std::vector<double> cars;
  std::vector<double> area;
};

// Caches the features of the last step, and recomputes them if their options differ.
class FeatureCache {
 public:
  FeatureCache(const ExperimentSettings& settings, std::vector<CategoryListRow> rows)
      : settings_(settings), rows_(std::move(rows)) {}

  Expected<const CaltechFeatures*> Of(const CategoryFeatureOptions& options) {
    std::string text = OptionsToJsonText(options);
    if (!features_ || text != made_with_) {
      features_.reset();
      VICTORIOUS_ASSIGN_OR_RETURN(features_, CaltechFeatures::Load(settings_, rows_, options));
      made_with_ = std::move(text);
    }
    return &*features_;
  }

 private:
  const ExperimentSettings& settings_;
  std::vector<CategoryListRow> rows_;
  std::optional<CaltechFeatures> features_;
  std::string made_with_;
};

Expected<Report> Accuracies(const ExperimentSettings& settings, std::span<const Step> steps) {
  const std::array<std::string, 2> pair = {kAirplanes, kCars};
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<CategoryListRow> rows, ReadCaltechRows(settings, pair));
  FeatureCache cache(settings, std::move(rows));
  Report report{.columns = {"method", "words or phrases", "airplanes", "cars", "area under ROC"}};
  std::map<std::string, PlotLine> lines;
  double place = 0;
  for (const Step& step : steps) {
    VICTORIOUS_ASSIGN_OR_RETURN(const CaltechFeatures* features, cache.Of(step.options.features));
    std::map<CategoryMethod, MethodFigures> figures;
    for (int seed = 1; seed <= settings.seeds; ++seed) {
      VICTORIOUS_RETURN_IF_ERROR(settings.CheckCancelled());
      CategoryModel model;
      VICTORIOUS_ASSIGN_OR_RETURN(
          const TestScores scores,
          TrainAndTest(*features, step.options.category, static_cast<std::uint64_t>(seed), {}, {}, &model));
      for (const auto& [method, name] : kMethods) {
        const Ranking ranking = ComputeRanking(scores, model, method, kAirplanes);
        figures[method].airplanes.push_back(100 * ComputeAccuracy(scores, model, method, kAirplanes));
        figures[method].cars.push_back(100 * ComputeAccuracy(scores, model, method, kCars));
        figures[method].area.push_back(RocArea(ranking.scores, ranking.is_positive));
      }
    }
    ++place;
    for (const auto& [method, name] : kMethods) {
      const MethodFigures& found = figures[method];
      const MeanWithError airplanes = ComputeMean(found.airplanes);
      const MeanWithError cars = ComputeMean(found.cars);
      report.rows.push_back({step.name, std::string(name), airplanes, cars, ComputeMean(found.area)});
      lines[std::string("airplanes, ") + name].points.push_back({place, airplanes.mean, airplanes.standard_error});
      lines[std::string("cars, ") + name].points.push_back({place, cars.mean, cars.standard_error});
      settings.progress(fmt::format("{}, {}: {:.2f} +- {:.2f}, {:.2f} +- {:.2f}", step.name, name, airplanes.mean,
                                    airplanes.standard_error, cars.mean, cars.standard_error));
    }
  }
  report.notes = {fmt::format("{} seeds, means and standard errors; below two standard errors, no difference. {}.",
                              settings.seeds, kSplitNote)};
  report.plot = {.title = "Accuracy of airplanes and cars",
                 .x = {.label = "method, in the order of the table"},
                 .y = {.label = "accuracy (%)", .low = 40, .high = 100}};
  for (auto& [name, line] : lines) {
    line.name = name;
    report.plot.lines.push_back(line);
  }
  return report;
}

}  // namespace

Expected<Report> RunTable37(const ExperimentSettings& settings) {
  VICTORIOUS_ASSIGN_OR_RETURN(Report report, Accuracies(settings, Methods()));
  report.title = "Accuracy (%) of airplanes and cars, 30 training images each";
  const std::vector<std::vector<Cell>> printed = {
      {std::string("Vedaldi, as the thesis quotes him"), std::string("words"), 90.26, 79.57, std::string()},
      {std::string("thesis"), std::string("words"), 90.99, 89.60, std::string()},
      {std::string("thesis"), std::string("phrases"), 92.12, 90.19, std::string()}};
  report.rows.insert(report.rows.begin(), printed.begin(), printed.end());
  return report;
}

Expected<Report> RunTableSteps(const ExperimentSettings& settings) {
  VICTORIOUS_ASSIGN_OR_RETURN(Report report, Accuracies(settings, Steps()));
  report.title = "Accuracy (%) of airplanes and cars, step by step: each step includes those before it";
  return report;
}

}  // namespace victorious

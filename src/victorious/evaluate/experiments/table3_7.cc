// Table 3.7: accuracy of airplanes and cars, words and phrases, the thesis's method and, step by step, ours; and the
// mean accuracy of the twelve categories of the data.
#include <array>
#include <functional>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "victorious/evaluate/experiments/caltech.h"
#include "victorious/evaluate/experiments/category_experiments.h"

namespace victorious {
namespace {

struct Step {
  std::string name;
  CategoryTrainOptions options;
  bool of_twelve = false;  ///< also on all twelve categories
};

// Each step with what the ones before it changed.
std::vector<Step> Steps() {
  std::vector<Step> steps;
  CategoryTrainOptions options = ThesisCategories();
  steps.push_back({"thesis's method", options});
  options.category.grammar.kernel_cap = kSmootherCap;
  steps.push_back({fmt::format("cap of equation 3.1 lowered to {:g}", kSmootherCap), options});
  options.category.scoring = "linear";
  steps.push_back({"counts with learned weights", options});
  options.features.surroundings = "learn";
  steps.push_back({"learned with surroundings", options});
  options.features.kind = "dense";
  steps.push_back({"features on a grid", options});
  options.category.vocabulary.root = true;
  steps.push_back({"RootSIFT", options});
  steps.push_back({"soft words: ours, the default", CategoryTrainOptions(), true});
  return steps;
}

constexpr std::array kMethods = {std::pair{CategoryMethod::kWords, "words"},
                                 std::pair{CategoryMethod::kPhrases, "phrases"}};

struct Figures {
  std::vector<double> airplanes;
  std::vector<double> cars;
  std::vector<double> twelve;
};

// Features are made anew only where the options for them differ from the last step's.
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

}  // namespace

Expected<Report> RunTable37(const ExperimentSettings& settings) {
  const std::array<std::string, 2> pair = {kAirplanes, kCars};
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<CategoryListRow> pair_rows, CaltechRows(settings, pair));
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<CategoryListRow> all_rows, CaltechRows(settings, {}));
  FeatureCache of_pair(settings, std::move(pair_rows));
  FeatureCache of_all(settings, std::move(all_rows));

  Report report{.title = "Accuracy (%) on Caltech-101, 30 training pictures each",
                .columns = {"method", "words or phrases", "airplanes", "cars", "12 categories, mean"}};
  report.rows = {{std::string("Vedaldi, as the thesis quotes him"), std::string("words"), 90.26, 79.57, std::string()},
                 {std::string("thesis"), std::string("words"), 90.99, 89.60, std::string()},
                 {std::string("thesis"), std::string("phrases"), 92.12, 90.19, std::string()}};
  std::map<std::string, PlotLine> lines;
  double place = 0;
  for (const Step& step : Steps()) {
    std::map<CategoryMethod, Figures> figures;
    const auto measure = [&](FeatureCache& cache, bool twelve) -> Status {
      VICTORIOUS_ASSIGN_OR_RETURN(const CaltechFeatures* features, cache.Of(step.options.features));
      for (int seed = 1; seed <= settings.seeds; ++seed) {
        VICTORIOUS_RETURN_IF_ERROR(settings.CheckCancelled());
        CategoryModel model;
        VICTORIOUS_ASSIGN_OR_RETURN(
            const TestScores scores,
            TrainAndTest(*features, step.options.category, static_cast<std::uint64_t>(seed), {}, {}, &model));
        for (const auto& [method, name] : kMethods) {
          if (twelve) {
            figures[method].twelve.push_back(100 * MeanAccuracy(scores, model, method));
            continue;
          }
          figures[method].airplanes.push_back(100 * AccuracyOf(scores, model, method, kAirplanes));
          figures[method].cars.push_back(100 * AccuracyOf(scores, model, method, kCars));
        }
      }
      return {};
    };
    VICTORIOUS_RETURN_IF_ERROR(measure(of_pair, false));
    if (step.of_twelve) VICTORIOUS_RETURN_IF_ERROR(measure(of_all, true));
    ++place;
    for (const auto& [method, name] : kMethods) {
      const Figures& found = figures[method];
      const Measured airplanes = MeanOf(found.airplanes);
      const Measured cars = MeanOf(found.cars);
      report.rows.push_back({step.name, std::string(name), airplanes, cars,
                             found.twelve.empty() ? Cell(std::string()) : Cell(MeanOf(found.twelve))});
      lines[std::string("airplanes, ") + name].points.push_back({place, airplanes.mean, airplanes.standard_error});
      lines[std::string("cars, ") + name].points.push_back({place, cars.mean, cars.standard_error});
    }
    settings.progress(step.name);
  }
  report.notes = {
      fmt::format("{} seeds, means and standard errors; a gap below two standard errors is none. Trained on "
                  "boxes, tested on whole pictures. Each step keeps those before it.",
                  settings.seeds)};
  report.plot = {.title = "Accuracy of airplanes and cars, step by step",
                 .x = {.label = "step, in the table's order"},
                 .y = {.label = "accuracy (%)", .low = 40, .high = 100}};
  for (auto& [name, line] : lines) {
    line.name = name;
    report.plot.lines.push_back(line);
  }
  return report;
}

}  // namespace victorious

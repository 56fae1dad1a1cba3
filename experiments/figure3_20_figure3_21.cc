// Figures 3.20 and 3.21: ROC of airplanes against cars and of cars against airplanes, for words and phrases. Curves are
// averaged over the seeds at fixed false alarm rates.
#include <array>
#include <map>

#include <fmt/format.h>

#include "experiments/caltech.h"
#include "experiments/category_experiments.h"
#include "experiments/roc.h"

namespace victorious {
namespace {

constexpr std::array kFalseAlarms = {0.0,  0.005, 0.01, 0.02, 0.03, 0.05, 0.075, 0.1,
                                     0.15, 0.2,   0.3,  0.4,  0.5,  0.7,  1.0};

struct Curve {
  std::array<std::vector<double>, kFalseAlarms.size()> detections;
  std::vector<double> area;

  void Add(const Ranking& ranking) {
    const std::vector<RocPoint> curve = RocCurve(ranking.scores, ranking.is_positive);
    for (std::size_t i = 0; i < kFalseAlarms.size(); ++i)
      detections[i].push_back(DetectionRateAt(curve, kFalseAlarms[i]));
    area.push_back(RocArea(ranking.scores, ranking.is_positive));
  }
};

Expected<Report> Roc(const ExperimentSettings& settings, const std::string& category, const std::string& title) {
  const std::array<std::string, 2> pair = {kAirplanes, kCars};
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<CategoryListRow> rows, ReadCaltechRows(settings, pair));
  const std::array methods = {std::pair{std::string("thesis as printed"), ThesisCategoriesAsPrinted()},
                              std::pair{std::string("thesis, words as prior"), ThesisCategories()},
                              std::pair{std::string("ours"), CategoryTrainOptions()}};
  Report report{.title = title, .columns = {"method", "words or phrases", "area under ROC"}};
  for (const double rate : kFalseAlarms) report.columns.push_back(fmt::format("detected at {:g}", rate));
  report.plot = {.title = title,
                 .x = {.label = "false alarm rate", .low = 0, .high = 1},
                 .y = {.label = "detection rate", .low = 0, .high = 1}};
  for (const auto& [name, options] : methods) {
    VICTORIOUS_ASSIGN_OR_RETURN(const auto features, CaltechFeatures::Load(settings, rows, options.features));
    std::map<std::string, Curve> curves;
    for (int seed = 1; seed <= settings.seeds; ++seed) {
      VICTORIOUS_RETURN_IF_ERROR(settings.CheckCancelled());
      CategoryModel model;
      VICTORIOUS_ASSIGN_OR_RETURN(
          const TestScores scores,
          TrainAndTest(features, options.category, static_cast<std::uint64_t>(seed), {}, {}, &model));
      curves["words"].Add(ComputeRanking(scores, model, CategoryMethod::kWords, category));
      curves["phrases"].Add(ComputeRanking(scores, model, CategoryMethod::kPhrases, category));
    }
    for (const auto& [method, curve] : curves) {
      std::vector<Cell> row = {name, method, ComputeMean(curve.area)};
      PlotLine line{.name = name + ", " + method, .points = {}, .connected = true, .marked = false};
      for (std::size_t i = 0; i < kFalseAlarms.size(); ++i) {
        const MeanWithError detected = ComputeMean(curve.detections[i]);
        row.emplace_back(detected);
        line.points.push_back({kFalseAlarms[i], detected.mean, detected.standard_error});
      }
      report.rows.push_back(std::move(row));
      report.plot.lines.push_back(std::move(line));
    }
    settings.progress(name);
  }
  report.notes = {
      fmt::format("{} seeds (thesis: 3 runs); airplanes and cars, 30 training images each, the rest for "
                  "testing.",
                  settings.seeds)};
  return report;
}

}  // namespace

Expected<Report> RunFigure320(const ExperimentSettings& settings) {
  return Roc(settings, kAirplanes, "ROC of airplanes among airplanes and cars");
}

Expected<Report> RunFigure321(const ExperimentSettings& settings) {
  return Roc(settings, kCars, "ROC of cars among airplanes and cars");
}

}  // namespace victorious

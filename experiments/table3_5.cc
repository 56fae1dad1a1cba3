// Table 3.5: run time of matching, each stage of the cascade and MLESAC on the running example.
#include <array>
#include <chrono>
#include <functional>
#include <vector>

#include <fmt/format.h>

#include "experiments/match_experiments.h"
#include "experiments/match_trial.h"
#include "victorious/lab/evaluate/score.h"
#include "victorious/search/match/matcher.h"

namespace victorious {
namespace {

constexpr std::size_t kSteps = 5;
constexpr std::array<const char*, kSteps> kStepNames = {"matching", "first", "second", "third", "MLESAC"};

struct PrintedTimes {
  double ratio;
  std::array<double, kSteps> seconds;
};

constexpr std::array<PrintedTimes, 6> kThesisTimes = {{{0.6, {0.00055, 0.000088, 0.000077, 0.000051, 0.0092}},
                                                       {0.7, {0.00056, 0.000094, 0.000087, 0.000065, 0.0093}},
                                                       {0.8, {0.00058, 0.00020, 0.000095, 0.000065, 0.0091}},
                                                       {0.85, {0.00057, 0.00085, 0.000094, 0.000073, 0.0094}},
                                                       {0.9, {0.00062, 0.0037, 0.0001, 0.0001, 0.3453}},
                                                       {0.95, {0.00058, 0.0202, 0.0002, 0.0001, 0.0093}}}};

// The median time of 31 runs, ms.
double MedianMs(const std::function<void()>& step) {
  constexpr std::size_t kRuns = 31;
  std::vector<double> ms(kRuns);
  for (double& time : ms) {
    const auto start = std::chrono::steady_clock::now();
    step();
    time = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  }
  return *Percentile(ms, 50);
}

std::array<double, kSteps> TimesMs(const MatchTrial& trial, double ratio, const RecognizeOptions& options) {
  const StageMatches left = RunStages(trial, ratio, options);
  const FeatureView view = trial.Template();
  const TemplateSet packed(std::span(&view, 1));
  std::array<double, kSteps> ms{};
  ms[0] = MedianMs([&] { MatchFeatures(trial.features->View(), packed, {.ratio = ratio}); });
  constexpr std::array kStages = {CascadeFilter::kFirst, CascadeFilter::kSecond, CascadeFilter::kThird};
  for (std::size_t stage = 1; stage <= kStages.size(); ++stage) {
    CascadeOptions alone = options.cascade;
    alone.filter = kStages[stage - 1];
    ms[stage] = MedianMs(
        [&] { FilterByGrammar(trial.features->keypoints, trial.Template().keypoints, left.sets[stage - 1], alone); });
  }
  ms[4] = MedianMs([&] { static_cast<void>(trial.Mlesac(left.sets[3], options.pose)); });
  return ms;
}

}  // namespace

Expected<Report> RunTable35(const ExperimentSettings& settings) {
  Report report{.title = "Time on the running example, milliseconds",
                .columns = {"ratio", "whose", "keypoints", "matches"}};
  report.columns.insert(report.columns.end(), kStepNames.begin(), kStepNames.end());
  report.columns.insert(report.columns.end(), {"three stages", "total"});
  std::array<PlotLine, 3> lines = {PlotLine{.name = "thesis"}, PlotLine{.name = "thesis setting reproduced"},
                                   PlotLine{.name = "ours"}};
  VICTORIOUS_ASSIGN_OR_RETURN(const MatchTrial thesis, RunningExample(settings, ThesisSetup(), "jeep"));
  VICTORIOUS_ASSIGN_OR_RETURN(const MatchTrial ours, RunningExample(settings, DefaultSetup(), "jeep"));
  for (const PrintedTimes& printed : kThesisTimes) {
    VICTORIOUS_RETURN_IF_ERROR(settings.CheckCancelled());
    const auto add = [&](const char* whose, const std::string& keypoints, Cell matches,
                         const std::array<double, kSteps>& ms, PlotLine& line) {
      std::vector<Cell> row = {printed.ratio, std::string(whose), keypoints, std::move(matches)};
      row.insert(row.end(), ms.begin(), ms.end());
      const double cascade = ms[1] + ms[2] + ms[3];
      row.emplace_back(cascade);
      row.emplace_back(ms[0] + cascade + ms[4]);
      report.rows.push_back(std::move(row));
      line.points.push_back({printed.ratio, cascade});
    };
    std::array<double, kSteps> thesis_ms = printed.seconds;
    for (double& time : thesis_ms) time *= 1e3;
    add("thesis", "1270 x 49", std::string(), thesis_ms, lines[0]);
    const auto add_trial = [&](const char* whose, const MatchTrial& trial, const MatchSetup& setup, PlotLine& line) {
      add(whose, fmt::format("{} x {}", trial.features->size(), trial.Template().size()),
          static_cast<double>(trial.Matches(printed.ratio).size()), TimesMs(trial, printed.ratio, setup.recognize),
          line);
    };
    add_trial("thesis setting reproduced", thesis, ThesisSetup(), lines[1]);
    add_trial("ours", ours, DefaultSetup(), lines[2]);
  }
  report.notes = {
      "Medians of 31 runs on one thread. The thesis matched on a GPU, ran the cascade in C++ and MLESAC in "
      "Matlab."};
  report.plot = {.title = "The three stages of the cascade",
                 .x = {.label = "ratio"},
                 .y = {.label = "ms", .low = 0.005, .high = 50, .logarithmic = true},
                 .lines = {lines.begin(), lines.end()}};
  return report;
}

}  // namespace victorious

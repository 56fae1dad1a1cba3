// Figure 5.2: recall and precision of objects under the default setting and its variations.
#include <algorithm>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "experiments/parameter_study.h"
#include "experiments/system_experiments.h"

namespace victorious {
namespace {

// Coincident settings are drawn once: one series for each number of coincident settings.
std::vector<PlotLine> PointsOf(const Study& study) {
  std::map<std::pair<double, double>, int> counts;
  for (const SettingResult& setting : study.settings) ++counts[{setting.Recall(), setting.Precision()}];
  std::map<int, PlotLine> lines;
  for (const auto& [point, count] : counts) {
    PlotLine& line = lines[-count];
    line.name = fmt::format("{} setting{}", count, count == 1 ? "" : "s");
    line.points.push_back({point.first, point.second});
    line.connected = false;
  }
  std::vector<PlotLine> plotted;
  for (auto& [count, line] : lines) plotted.push_back(std::move(line));
  return plotted;
}

}  // namespace

Expected<Report> RunFigure52(const ExperimentSettings& settings) {
  VICTORIOUS_ASSIGN_OR_RETURN(const Study study, RunStudy(settings));
  Report report{
      .title = "Object recall and precision with the default setting and its variations",
      .columns = {"setting", "of", "objects", "found", "false", "recall", "precision", "ids per object", "density 50 %",
                  "place error 90 %, m", "sightings changed from default", "places changed from default"}};
  int whole = 0;
  int clean = 0;
  int perfect = 0;
  for (const SettingResult& setting : study.settings) {
    whole += setting.Recall() == 1 ? 1 : 0;
    clean += setting.Precision() == 1 ? 1 : 0;
    perfect += setting.Recall() == 1 && setting.Precision() == 1 ? 1 : 0;
    const Study alone{.movies = {}, .settings = {setting}};
    const std::optional<double> density = Percentile(CollectValues(alone, &ObjectResult::density), 50);
    const std::optional<double> error_m = Percentile(CollectValues(alone, &ObjectResult::error_m), 90);
    report.rows.push_back(
        {setting.name, setting.of, static_cast<double>(setting.findable), static_cast<double>(setting.found),
         static_cast<double>(setting.false_objects), setting.Recall(), setting.Precision(), setting.IdsPerObject(),
         density ? Cell(*density) : Cell("-"), error_m ? Cell(*error_m) : Cell("-"),
         static_cast<double>(setting.changed_sightings), static_cast<double>(setting.changed_places)});
  }
  report.notes = {
      fmt::format("Of {} settings {} have a recall of 1, {} a precision of 1, {} both (thesis: recall 1 with a "
                  "precision above 0.8 in 26 of 29, both 1 in 8).",
                  study.settings.size(), whole, clean, perfect),
      DescribeStudy(study),
      "The last two columns show the effect of a parameter: sightings that only one of the two settings has, and "
      "objects whose place error differs by 1 mm or more."};
  report.plot = {.title = "Objects, 29 settings",
                 .x = {.label = "recall", .low = 0, .high = 1.05},
                 .y = {.label = "precision", .low = 0, .high = 1.05},
                 .lines = PointsOf(study)};
  return report;
}

}  // namespace victorious

// Figure 5.3: frame detection density, the fraction of the frames in view in which an object is reported, over all
// settings, movies and objects; and with the default setting in the movies of another renderer, if there are any.
#include <algorithm>
#include <map>
#include <set>

#include <fmt/format.h>

#include "experiments/movie_search.h"
#include "experiments/parameter_study.h"
#include "experiments/system_experiments.h"

namespace victorious {
namespace {

using Chosen = std::function<bool(const ObjectResult&)>;

void AddRow(const std::string& what, const Study& study, const Chosen& chosen, Report& report) {
  const auto densities = [&](double ObjectResult::* member) {
    return CollectValues(study, [&](const ObjectResult& object) {
      return chosen(object) ? std::optional(object.*member) : std::nullopt;
    });
  };
  const std::vector<double> in_view = densities(&ObjectResult::density);
  if (in_view.empty()) return;
  std::vector<Cell> row = {what, static_cast<double>(in_view.size()), std::ranges::min(in_view)};
  for (const auto member : {&ObjectResult::density, &ObjectResult::density_between}) {
    for (const double percent : {25, 50, 75}) row.emplace_back(*Percentile(densities(member), percent));
  }
  report.rows.push_back(std::move(row));
}

// Describes the range of the densities between settings of one object, and between objects of one setting.
std::string DescribeRange(const Study& study) {
  std::map<std::pair<std::string, std::string>, std::vector<double>> by_object;
  std::vector<double> within;
  for (const SettingResult& setting : study.settings) {
    std::vector<double> densities;
    for (const ObjectResult& object : setting.objects) {
      by_object[{object.movie, object.name}].push_back(object.density);
      densities.push_back(object.density);
    }
    const auto [least, most] = std::ranges::minmax(densities);
    within.push_back(most - least);
  }
  std::vector<double> between;
  for (const auto& [object, densities] : by_object) {
    const auto [least, most] = std::ranges::minmax(densities);
    between.push_back(most - least);
  }
  return fmt::format(
      "The range of the density is {:.2f} over the objects of one setting and {:.2f} over the settings of one object "
      "(medians).",
      *Percentile(within, 50), *Percentile(between, 50));
}

}  // namespace

Expected<Report> RunFigure53(const ExperimentSettings& settings) {
  VICTORIOUS_ASSIGN_OR_RETURN(const Study study, RunStudy(settings));
  Report report{.title = "Frame detection density",
                .columns = {"objects of", "densities", "least", "in view, 25 %", "in view, 50 %", "in view, 75 %",
                            "first to last, 25 %", "first to last, 50 %", "first to last, 75 %"}};
  AddRow("all movies and settings", study, [](const ObjectResult&) { return true; }, report);
  std::set<std::string> kinds;
  for (const ObjectResult& object : study.settings.front().objects) kinds.insert(object.model);
  for (const MovieWithTruth& movie : study.movies) {
    AddRow(movie.name, study, [&](const ObjectResult& object) { return object.movie == movie.name; }, report);
  }
  for (const std::string& kind : kinds) {
    AddRow(kind, study, [&](const ObjectResult& object) { return object.model == kind; }, report);
  }
  report.plot = {.title = "Frame detection density",
                 .x = {.label = "fraction of the frames in view", .low = 0, .high = 1.02},
                 .y = {.label = "fraction of objects and settings", .low = 0, .high = 1},
                 .lines = {MakeCumulativeLine("the project's movies", CollectValues(study, &ObjectResult::density))}};
  report.notes = {
      "In view: the fraction of the frames in which an object is clear that report it. First to last: the same from "
      "its first to its last report, because an object that enters between two whole-frame searches is detected in the "
      "next. Thesis: 0.452, 0.634, 0.896 at 25, 50 and 75 %.",
      DescribeRange(study), DescribeStudy(study)};

  const Expected<std::vector<std::filesystem::path>> folders = FindMovies(settings);
  if (!folders) {
    report.notes.push_back("No movies of another renderer: " + folders.error().message + ".");
    return report;
  }
  std::vector<MovieWithTruth> given;
  for (const std::filesystem::path& folder : *folders) {
    VICTORIOUS_ASSIGN_OR_RETURN(given.emplace_back(), ReadMovie(folder, settings));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const Study others, StudyMovies(std::move(given), {StudySettings().front()}, settings));
  for (const MovieWithTruth& movie : others.movies) {
    AddRow(
        movie.name + ", default", others, [&](const ObjectResult& object) { return object.movie == movie.name; },
        report);
  }
  report.plot.lines.push_back(
      MakeCumulativeLine("another renderer's, default", CollectValues(others, &ObjectResult::density)));
  report.notes.push_back("Another renderer, default setting only: " + DescribeMovies(others.movies) + ".");
  return report;
}

}  // namespace victorious

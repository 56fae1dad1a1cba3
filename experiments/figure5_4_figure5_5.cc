// Figures 5.4 and 5.5: place errors by kind of object, and of the helicopter compared with all other kinds.
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include <fmt/format.h>

#include "experiments/parameter_study.h"
#include "experiments/system_experiments.h"

namespace victorious {
namespace {

constexpr const char* kHelicopter = "helicopter";  // in place of the thesis's Apache
constexpr double kBinM = 0.02;

std::vector<double> ErrorsOf(const Study& study, const std::function<bool(const std::string& model)>& chosen) {
  return CollectValues(
      study, [&](const ObjectResult& object) { return chosen(object.model) ? object.error_m : std::nullopt; });
}

std::set<std::string> KindsOf(const Study& study) {
  std::set<std::string> kinds;
  for (const MovieWithTruth& movie : study.movies) {
    for (const TruthRow& row : movie.truth) kinds.insert(row.model);
  }
  return kinds;
}

// A histogram of counts or fractions; larger errors count in the last bin.
PlotLine Histogram(const std::string& name, const std::vector<double>& errors_m, double max_m, bool normalised) {
  const auto bins = static_cast<std::size_t>(std::ceil(max_m / kBinM));
  std::vector<double> counts(bins, 0);
  for (const double error_m : errors_m) {
    const auto bin = std::min(static_cast<std::size_t>(error_m / kBinM), bins - 1);
    counts[bin] += normalised ? 1 / static_cast<double>(errors_m.size()) : 1;
  }
  PlotLine line{.name = name, .points = {}, .marked = false};
  for (std::size_t bin = 0; bin < bins; ++bin) {
    line.points.push_back({static_cast<double>(bin) * kBinM, counts[bin]});
    line.points.push_back({static_cast<double>(bin + 1) * kBinM, counts[bin]});
  }
  return line;
}

Expected<std::string> NearestNote(const Study& study) {
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const MovieWithTruth& movie : study.movies) {
    VICTORIOUS_ASSIGN_OR_RETURN(const double of_movie_m, MinRangeM(movie));
    nearest_m = std::min(nearest_m, of_movie_m);
  }
  return fmt::format(
      "Horizontal errors, one for each found object, movie and setting. The minimum distance of an object to the "
      "camera is {:.0f} m (thesis: 100 m).",
      nearest_m);
}

Report Described(const std::string& title, std::vector<std::string> notes) {
  return {
      .title = title,
      .notes = std::move(notes),
      .columns = {"objects", "errors", "CEP 50 %, m", "75 %, m", "90 %, m", "largest, m", "thesis: 50 / 75 / 90 %, m"}};
}

void AddRow(const std::string& name, const std::vector<double>& errors_m, const char* thesis, Report& report) {
  report.rows.push_back({name, static_cast<double>(errors_m.size()), FormatPercentile(errors_m, 50),
                         FormatPercentile(errors_m, 75), FormatPercentile(errors_m, 90),
                         FormatPercentile(errors_m, 100), std::string(thesis)});
}

constexpr const char* kThesisApache = "1.9 / 2.62 / 7.32";
constexpr const char* kThesisOthers = "0.8 / 1.42 / 1.88";

// The upper end of the plots, limited so that a single outlier does not compress the others into the first bin.
double LastBinM(const Study& study) {
  constexpr double kBeyondMost = 3;
  const std::vector<double> errors_m = ErrorsOf(study, [](const std::string&) { return true; });
  return kBinM + std::min(kBeyondMost * Percentile(errors_m, 90).value_or(0), Percentile(errors_m, 100).value_or(0));
}

constexpr const char* kErrorLabel = "horizontal error, m; larger errors count in the last bin";

}  // namespace

Expected<Report> RunFigure54(const ExperimentSettings& settings) {
  VICTORIOUS_ASSIGN_OR_RETURN(const Study study, RunStudy(settings));
  VICTORIOUS_ASSIGN_OR_RETURN(std::string nearest, NearestNote(study));
  Report report = Described("Place errors by kind of object", {std::move(nearest), DescribeStudy(study)});
  report.plot = {.title = "Place errors by kind of object",
                 .x = {.label = kErrorLabel},
                 .y = {.label = "fraction of the kind's errors"},
                 .lines = {}};
  const double max_m = LastBinM(study);
  for (const std::string& kind : KindsOf(study)) {
    const std::vector<double> errors_m = ErrorsOf(study, [&](const std::string& model) { return model == kind; });
    AddRow(kind, errors_m, kind == kHelicopter ? kThesisApache : kThesisOthers, report);
    report.plot.lines.push_back(Histogram(kind, errors_m, max_m, /*normalised=*/true));
  }
  return report;
}

Expected<Report> RunFigure55(const ExperimentSettings& settings) {
  VICTORIOUS_ASSIGN_OR_RETURN(const Study study, RunStudy(settings));
  VICTORIOUS_ASSIGN_OR_RETURN(std::string nearest, NearestNote(study));
  Report report =
      Described("Place errors of the helicopter and of all other kinds", {std::move(nearest), DescribeStudy(study)});
  const std::vector<double> of_helicopters = ErrorsOf(study, [](const std::string& m) { return m == kHelicopter; });
  const std::vector<double> of_others = ErrorsOf(study, [](const std::string& m) { return m != kHelicopter; });
  AddRow(kHelicopter, of_helicopters, kThesisApache, report);
  AddRow("all others", of_others, kThesisOthers, report);
  const double max_m = LastBinM(study);
  report.plot = {.title = "Place errors of the helicopter and of all other kinds",
                 .x = {.label = kErrorLabel},
                 .y = {.label = "objects, movies and settings"},
                 .lines = {Histogram("helicopter", of_helicopters, max_m, /*normalised=*/false),
                           Histogram("all others", of_others, max_m, /*normalised=*/false)}};
  return report;
}

}  // namespace victorious

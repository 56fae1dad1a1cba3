// Places of surveyed points from cameras that do not move. There is no parallax, so that the ground determines the
// distance, and further images do not reduce the errors common to all lines.
#include <algorithm>
#include <vector>

#include "experiments/place_experiments.h"
#include "experiments/place_trials.h"
#include "victorious/base/median.h"
#include "victorious/lab/evaluate/place_score.h"
#include "victorious/place/geolocate/locate.h"

namespace victorious {
namespace {

// The configuration of a row.
struct PlaceVariant {
  LocateMethod method;
  std::size_t max_lines;
  bool surveyed_height;  // ground at the point's surveyed height; else flat, at the other points' mean height
};

constexpr std::size_t kAll = 1000;

void AddRow(const PlaceSeries& series, const PlaceVariant& way, Report& report) {
  std::vector<double> horizontal_error_m;
  std::vector<double> ce90_m;
  std::vector<double> le90_m;
  double in_ellipsoid = 0;
  double in_circle = 0;
  std::size_t lines = 0;
  std::string status;
  for (const PlaceTrial& trial : series.trials) {
    LocateOptions options = trial.locate_options;
    options.method = way.method;
    options.ground = std::make_shared<FlatGround>(way.surveyed_height ? trial.truth.altitude_m : trial.others_height_m);
    options.ground_sigma_m = way.surveyed_height ? 0.05 : trial.others_sigma_m;
    lines = std::min(way.max_lines, trial.lines.size());
    const auto fix = Locate(std::span(trial.lines).first(lines), options);
    if (!fix || !fix->place) {
      status = fix ? StatusText(*fix) : fix.error().message;
      continue;
    }
    const PlaceError error = ComputePlaceError(fix->place, std::nullopt, TruthRow{.place = trial.truth});
    horizontal_error_m.push_back(*error.horizontal_error_m);
    ce90_m.push_back(fix->place->ce90_m);
    le90_m.push_back(fix->place->le90_m);
    in_ellipsoid += error.in_ellipsoid ? 1 : 0;
    in_circle += error.in_ce90 ? 1 : 0;
  }
  std::vector<Cell> row = {series.name, std::string(way.surveyed_height ? "surveyed height" : "flat"),
                           std::string(ToText(kLocateMethodTexts, way.method)), static_cast<double>(lines),
                           static_cast<double>(horizontal_error_m.size())};
  if (horizontal_error_m.empty()) {
    row.insert(row.end(), {status, std::string("-"), std::string("-"), std::string("-"), 0.0, 0.0});
  } else {
    row.insert(row.end(), {Median(horizontal_error_m), std::ranges::max(horizontal_error_m), Median(ce90_m),
                           Median(le90_m), in_ellipsoid, in_circle});
  }
  report.rows.push_back(std::move(row));
}

}  // namespace

Expected<Report> RunTableControlPoints(const ExperimentSettings& settings) {
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<PlaceSeries> all, LoadNarrabeen(settings));
  VICTORIOUS_ASSIGN_OR_RETURN(PlaceSeries geul, LoadGeul(settings));
  all.push_back(std::move(geul));
  Report report{
      .title = "Surveyed points, located with cameras that do not move",
      .notes =
          {"One image and the method ground: the intersection of one ray with the ground. Flat ground: the mean height "
           "of the site's other points, with their scatter as standard deviation; surveyed height: the surveyed height "
           "of the point, with a standard deviation of 5 cm. Stated errors: solved poses 0.3 m and 0.02 deg, common to "
           "all images; telemetry the defaults (2 m, 0.5 deg), then 3 deg; the river's camera from its fit. The "
           "river's 30 images are one line of sight repeated 30 times."},
      .columns = {"site and cameras", "ground", "method", "images", "points located",
                  "error along the ground, median m", "max m", "CE90, median m", "LE90, median m",
                  "in the 90 % ellipsoid", "within CE90"}};
  const std::vector<PlaceVariant> ways = {{LocateMethod::kGround, 1, false},
                                          {LocateMethod::kMaximumLikelihood, 1, false},
                                          {LocateMethod::kMaximumLikelihood, 3, false},
                                          {LocateMethod::kGround, kAll, false},
                                          {LocateMethod::kMaximumLikelihood, kAll, false},
                                          {LocateMethod::kRansac, kAll, false},
                                          {LocateMethod::kPrior, kAll, false},
                                          {LocateMethod::kLeastSquares, kAll, false},
                                          {LocateMethod::kGround, 1, true},
                                          {LocateMethod::kMaximumLikelihood, kAll, true}};
  for (const PlaceSeries& series : all) {
    const std::size_t most =
        std::ranges::max(series.trials, {}, [](const PlaceTrial& t) { return t.lines.size(); }).lines.size();
    for (const PlaceVariant& way : ways) {
      if (most > 1 || way.max_lines == 1) AddRow(series, way, report);
    }
  }
  return report;
}

}  // namespace victorious

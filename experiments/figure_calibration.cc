// Calibration of detection scores: the reliability diagram, the expected calibration error, and the constants of the
// logistic curve fitted to true and false detections (reliability.h).
#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "experiments/movie_search.h"
#include "experiments/recognition_experiments.h"
#include "experiments/reliability.h"
#include "victorious/evaluate/score.h"

namespace victorious {
namespace {

// Labels the detections of a frame; those of truth rows that are not clear are left out.
std::vector<Judged> JudgedOf(const SearchedFrame& searched) {
  std::vector<Judged> judged;
  for (std::size_t i = 0; i < searched.detections.size(); ++i) {
    const std::optional<TruthRow>& truth = searched.truth[i];
    if (truth && !IsClear(*truth)) continue;
    judged.push_back({searched.detections[i].evidence, searched.detections[i].score, truth.has_value()});
  }
  return judged;
}

std::vector<Judged> Reported(std::vector<Judged> judged, double least_score) {
  std::erase_if(judged, [&](const Judged& one) { return one.score < least_score; });
  return judged;
}

std::vector<Cell> RowOf(const std::string& movie, const std::vector<Judged>& judged,
                        const std::vector<Judged>& by_others, double least_score) {
  const std::vector<Judged> reported = Reported(judged, least_score);
  const auto right = std::ranges::count(reported, true, &Judged::right);
  return {movie,
          static_cast<double>(judged.size()),
          CalibrationError(judged),
          static_cast<double>(reported.size()),
          reported.empty() ? Cell("-") : Cell(static_cast<double>(right) / static_cast<double>(reported.size())),
          CalibrationError(reported),
          by_others.empty() ? Cell("-") : Cell(CalibrationError(by_others))};
}

std::vector<Judged> Together(const std::vector<std::vector<Judged>>& of_movies) {
  std::vector<Judged> all;
  for (const std::vector<Judged>& one : of_movies) all.insert(all.end(), one.begin(), one.end());
  return all;
}

PlotLine LineOf(const char* name, const std::vector<Judged>& judged) {
  PlotLine line{.name = name, .points = {}};
  for (const ReliabilityBin& bin : Reliability(judged)) {
    if (bin.count > 0) line.points.push_back({bin.mean_score, bin.right, bin.standard_error});
  }
  return line;
}

}  // namespace

Expected<Report> RunFigureCalibration(const ExperimentSettings& settings) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<std::filesystem::path> movies, MoviesOf(settings));
  IndexOptions options;
  DetectOptions& detect = options.recognize.detect;
  const double least_score = std::exchange(detect.least_score, 0.0);
  Report report{.title = "Calibration of detection scores",
                .columns = {"movie", "detections", "calibration error", "of these reported", "right among reported",
                            "their calibration error", "calibration error by the other movies' curve"}};
  std::vector<std::vector<Judged>> of_movies;
  for (const std::filesystem::path& movie : movies) {
    std::vector<Judged> judged;
    VICTORIOUS_RETURN_IF_ERROR(SearchMovie({.movie = movie, .options = options}, settings,
                                           [&](const SearchedFrame& searched, const std::vector<ObjectModel>&) {
                                             std::ranges::copy(JudgedOf(searched), std::back_inserter(judged));
                                             return Status{};
                                           }));
    of_movies.push_back(std::move(judged));
  }
  const std::vector<std::vector<Judged>> by_others = ScoredByOthers(of_movies);
  for (std::size_t i = 0; i < movies.size(); ++i)
    report.rows.push_back(RowOf(movies[i].filename().string(), of_movies[i], by_others[i], least_score));
  const std::vector<Judged> all = Together(of_movies);
  report.rows.push_back(RowOf("all", all, Together(by_others), least_score));
  const Logistic fitted = FitLogistic(all);
  report.notes = {
      fmt::format("At most 20 frames per movie, all detections without a minimum score (reported: scores of {:g} or "
                  "more). The calibration error is the expected one over 10 bins of the score. In the last column the "
                  "curve is fitted to all other movies (leave-one-out).",
                  least_score),
      fmt::format("Fitted to all movies: detect.even_evidence {:.2f}, detect.evidence_scale {:.2f} decades; in use: "
                  "{:.2f} and {:.2f}.",
                  fitted.even, fitted.scale, detect.even_evidence, detect.evidence_scale)};
  report.plot = {.title = "Reliability of scores",
                 .x = {.label = "score", .low = 0, .high = 1},
                 .y = {.label = "fraction of true detections", .low = 0, .high = 1},
                 .lines = {LineOf("all detections", all),
                           LineOf("those reported", Reported(all, least_score)),
                           {.name = "perfect", .points = {{0, 0}, {1, 1}}, .marked = false}}};
  return report;
}

}  // namespace victorious

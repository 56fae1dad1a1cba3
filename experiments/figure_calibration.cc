// Calibration of detection scores: the reliability diagram, the expected calibration error, and the constants of the
// logistic curve fitted to true and false detections (reliability.h).
#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "experiments/movie_search.h"
#include "experiments/recognition_experiments.h"
#include "experiments/reliability.h"
#include "victorious/lab/evaluate/score.h"

namespace victorious {
namespace {

// Labels the detections of a frame; those of truth rows that are not clear are left out.
std::vector<LabelledDetection> LabelDetections(const SearchedFrame& searched) {
  std::vector<LabelledDetection> labelled;
  for (std::size_t i = 0; i < searched.detections.size(); ++i) {
    const std::optional<TruthRow>& truth = searched.truth[i];
    if (truth && !IsClear(*truth)) continue;
    labelled.push_back({searched.detections[i].neg_log10_nfa, searched.detections[i].score, truth.has_value()});
  }
  return labelled;
}

std::vector<LabelledDetection> FilterByScore(std::vector<LabelledDetection> labelled, double min_score) {
  std::erase_if(labelled, [&](const LabelledDetection& one) { return one.score < min_score; });
  return labelled;
}

std::vector<Cell> MakeRow(const std::string& movie, const std::vector<LabelledDetection>& labelled,
                          const std::vector<LabelledDetection>& cross_validated, double min_score) {
  const std::vector<LabelledDetection> reported = FilterByScore(labelled, min_score);
  const auto correct = std::ranges::count(reported, true, &LabelledDetection::correct);
  return {movie,
          static_cast<double>(labelled.size()),
          CalibrationError(labelled),
          static_cast<double>(reported.size()),
          reported.empty() ? Cell("-") : Cell(static_cast<double>(correct) / static_cast<double>(reported.size())),
          CalibrationError(reported),
          cross_validated.empty() ? Cell("-") : Cell(CalibrationError(cross_validated))};
}

std::vector<LabelledDetection> Concatenate(const std::vector<std::vector<LabelledDetection>>& of_movies) {
  std::vector<LabelledDetection> all;
  for (const std::vector<LabelledDetection>& one : of_movies) all.insert(all.end(), one.begin(), one.end());
  return all;
}

PlotLine ReliabilityLine(const char* name, const std::vector<LabelledDetection>& labelled) {
  PlotLine line{.name = name, .points = {}};
  for (const ReliabilityBin& bin : Reliability(labelled)) {
    if (bin.count > 0) line.points.push_back({bin.mean_score, bin.correct, bin.standard_error});
  }
  return line;
}

}  // namespace

Expected<Report> RunFigureCalibration(const ExperimentSettings& settings) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<std::filesystem::path> movies, FindMovies(settings));
  IndexOptions options;
  DetectOptions& detect = options.recognize.detect;
  const double min_score = std::exchange(detect.min_score, 0.0);
  Report report{.title = "Calibration of detection scores",
                .columns = {"movie", "detections", "calibration error", "reported", "precision of reported",
                            "calibration error of reported", "cross-validated calibration error"}};
  std::vector<std::vector<LabelledDetection>> of_movies;
  for (const std::filesystem::path& movie : movies) {
    std::vector<LabelledDetection> labelled;
    VICTORIOUS_RETURN_IF_ERROR(SearchMovie({.movie = movie, .options = options}, settings,
                                           [&](const SearchedFrame& searched, const std::vector<ObjectModel>&) {
                                             std::ranges::copy(LabelDetections(searched), std::back_inserter(labelled));
                                             return Status{};
                                           }));
    of_movies.push_back(std::move(labelled));
  }
  const std::vector<std::vector<LabelledDetection>> cross_validated = CrossValidate(of_movies);
  for (std::size_t i = 0; i < movies.size(); ++i)
    report.rows.push_back(MakeRow(movies[i].filename().string(), of_movies[i], cross_validated[i], min_score));
  const std::vector<LabelledDetection> all = Concatenate(of_movies);
  report.rows.push_back(MakeRow("all", all, Concatenate(cross_validated), min_score));
  const Logistic fitted = FitLogistic(all);
  report.notes = {
      fmt::format("At most 20 frames per movie, all detections without a minimum score (reported: scores of {:g} or "
                  "more). The calibration error is the expected one over 10 bins of the score. In the last column the "
                  "curve is fitted to all other movies (leave-one-out).",
                  min_score),
      fmt::format("Fitted to all movies: midpoint {:.2f}, scale {:.2f} decades; in use: "
                  "{:.2f} and {:.2f}.",
                  fitted.midpoint, fitted.scale, kScoreMidpoint, kScoreScale)};
  report.plot = {.title = "Reliability of scores",
                 .x = {.label = "score", .low = 0, .high = 1},
                 .y = {.label = "fraction of true detections", .low = 0, .high = 1},
                 .lines = {ReliabilityLine("all detections", all),
                           ReliabilityLine("those reported", FilterByScore(all, min_score)),
                           {.name = "perfect", .points = {{0, 0}, {1, 1}}, .marked = false}}};
  return report;
}

}  // namespace victorious

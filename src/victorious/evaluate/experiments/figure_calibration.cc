// Whether scores are probabilities: of the detections scored 0.9, are nine in ten right? And the constants that make
// them so, of the logistic curve of the evidence that fits what is found right and wrong.
#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "victorious/evaluate/experiments/movie_search.h"
#include "victorious/evaluate/experiments/recognition_experiments.h"
#include "victorious/evaluate/experiments/reliability.h"
#include "victorious/evaluate/score.h"

namespace victorious {
namespace {

// Rightly or wrongly found; what shows too little of an object counts neither way.
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

std::vector<Cell> RowOf(const std::string& movie, const std::vector<Judged>& judged, double least_score) {
  const std::vector<Judged> reported = Reported(judged, least_score);
  const auto right = std::ranges::count(reported, true, &Judged::right);
  return {movie,
          static_cast<double>(judged.size()),
          CalibrationError(judged),
          static_cast<double>(reported.size()),
          reported.empty() ? Cell("-") : Cell(static_cast<double>(right) / static_cast<double>(reported.size())),
          CalibrationError(reported)};
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
  options.daylight.sun = "off";  // to be found it takes as long as the rest, and evidence means the same without it
  DetectOptions& detect = options.recognize.detect;
  const double least_score = std::exchange(detect.least_score, 0.0);
  Report report{.title = "Scores as probabilities",
                .columns = {"movie", "detections", "calibration error", "of these reported", "right among reported",
                            "their calibration error"}};
  std::vector<Judged> all;
  for (const std::filesystem::path& movie : movies) {
    std::vector<Judged> judged;
    VICTORIOUS_RETURN_IF_ERROR(SearchMovie({.movie = movie, .options = options}, settings,
                                           [&](const SearchedFrame& searched, const std::vector<ObjectModel>&) {
                                             std::ranges::copy(JudgedOf(searched), std::back_inserter(judged));
                                             return Status{};
                                           }));
    report.rows.push_back(RowOf(movie.filename().string(), judged, least_score));
    all.insert(all.end(), judged.begin(), judged.end());
  }
  report.rows.push_back(RowOf("all", all, least_score));
  const Logistic fitted = FitLogistic(all);
  report.notes = {
      fmt::format("At most 20 frames a movie, every detection however weak, sought without the sun (reported: those "
                  "scored {:g} and more). The "
                  "calibration error is the expected one over 10 bins of the score.",
                  least_score),
      fmt::format("Fitted to all of them: detect.even_evidence {:.2f}, detect.evidence_scale {:.2f} decades; in use: "
                  "{:.2f} and {:.2f}.",
                  fitted.even, fitted.scale, detect.even_evidence, detect.evidence_scale)};
  report.plot = {.title = "Reliability of scores",
                 .x = {.label = "score", .low = 0, .high = 1},
                 .y = {.label = "share that is right", .low = 0, .high = 1},
                 .lines = {LineOf("all detections", all),
                           LineOf("those reported", Reported(all, least_score)),
                           {.name = "perfect", .points = {{0, 0}, {1, 1}}, .marked = false}}};
  return report;
}

}  // namespace victorious

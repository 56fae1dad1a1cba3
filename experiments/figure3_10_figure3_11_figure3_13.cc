// Figures 3.10, 3.11 and 3.13: drawings of the matches after each stage, at one ratio and at several.
#include <array>
#include <span>

#include <fmt/format.h>

#include "experiments/draw_matches.h"
#include "experiments/match_experiments.h"
#include "experiments/match_trial.h"
#include "victorious/input/image/image_file.h"
#include "victorious/input/image/montage.h"

namespace victorious {
namespace {

// One drawing per ratio (downwards) and stage (across); the counts as rows.
struct Drawn {
  std::vector<cv::Mat> images;
  Report report;
};

Expected<Drawn> DrawStages(const ExperimentSettings& settings, const std::string& kind, std::span<const double> ratios,
                           std::size_t stages, double scale) {
  const MatchSetup setup = DefaultSetup();
  VICTORIOUS_ASSIGN_OR_RETURN(const MatchTrial trial, RunningExample(settings, setup, kind));
  Drawn drawn;
  drawn.report.columns = {"ratio", "filtering", "matches", "true", "false"};
  drawn.report.notes = {
      fmt::format("{}; our setting. Red: true; cyan: false; yellow: near, which is neither.", trial.name)};
  for (const double ratio : ratios) {
    const StageMatches left = RunStages(trial, ratio, setup.recognize);
    for (std::size_t stage = 0; stage < stages; ++stage) {
      const MatchCount count = trial.Count(left.sets[stage]);
      const std::string caption = fmt::format("{:g} {}: {} true, {} false", ratio, StageMatches::kNames[stage],
                                              count.correct, count.FalseMatches());
      VICTORIOUS_ASSIGN_OR_RETURN(cv::Mat image, DrawMatches(trial, left.sets[stage], scale, caption));
      drawn.images.push_back(std::move(image));
      drawn.report.rows.push_back({ratio, std::string(StageMatches::kNames[stage]), static_cast<double>(count.matches),
                                   static_cast<double>(count.correct), static_cast<double>(count.FalseMatches())});
    }
  }
  return drawn;
}

}  // namespace

Expected<Report> RunFigure310(const ExperimentSettings& settings) {
  constexpr std::array kRatio = {0.8};
  VICTORIOUS_ASSIGN_OR_RETURN(Drawn drawn, DrawStages(settings, "jeep", kRatio, 4, 0.5));
  // Clockwise from the upper left corner, as in the thesis.
  std::swap(drawn.images[2], drawn.images[3]);
  VICTORIOUS_RETURN_IF_ERROR(WriteImage(settings.out / "figure3.10.png", Montage(drawn.images, 2)));
  drawn.report.title =
      "Matches at a ratio of 0.8, clockwise from the upper left corner: none, first, second, third stage";
  return drawn.report;
}

Expected<Report> RunFigure311(const ExperimentSettings& settings) {
  constexpr std::array kRatios = {0.6, 0.7, 0.8, 0.85, 0.9, 0.95};
  VICTORIOUS_ASSIGN_OR_RETURN(Drawn drawn, DrawStages(settings, "jeep", kRatios, 4, 0.25));
  VICTORIOUS_RETURN_IF_ERROR(WriteImage(settings.out / "figure3.11.png", Montage(drawn.images, 4)));
  drawn.report.title = "Matches at ratios from 0.6 to 0.95 (downwards) after each stage (across)";
  return drawn.report;
}

Expected<Report> RunFigure313(const ExperimentSettings& settings) {
  constexpr std::array kRatios = {0.8, 0.85, 0.9, 0.95};
  VICTORIOUS_ASSIGN_OR_RETURN(Drawn drawn, DrawStages(settings, "jet", kRatios, 5, 0.22));
  VICTORIOUS_RETURN_IF_ERROR(WriteImage(settings.out / "figure3.13.png", Montage(drawn.images, 5)));
  drawn.report.title = "The second object at ratios from 0.8 to 0.95 (downwards) after each stage and MLESAC (across)";
  return drawn.report;
}

}  // namespace victorious

// Table 3.2: true and false matches of the running example at a ratio of 0.8 after each stage.
#include <array>

#include <fmt/format.h>

#include "experiments/match_experiments.h"
#include "experiments/match_trial.h"

namespace victorious {
namespace {

struct ThesisRow {
  int matches;
  int correct;
};

// Table 3.2 of the thesis; it gives no count for MLESAC.
constexpr std::array<ThesisRow, 4> kThesis = {{{80, 10}, {15, 10}, {10, 10}, {10, 10}}};
constexpr double kTableRatio = 0.8;

}  // namespace

Expected<Report> RunTable32(const ExperimentSettings& settings) {
  Report report{.title = "Matches of one template in a noisy image, at a ratio of 0.8, after each stage of the cascade",
                .columns = {"filtering", "thesis: matches", "thesis: true", "thesis: false",
                            "thesis setting reproduced: matches", "thesis setting reproduced: true",
                            "thesis setting reproduced: false", "thesis setting reproduced: true / template",
                            "thesis setting reproduced: false / rest of scene", "ours: matches", "ours: true",
                            "ours: false", "ours: true / template", "ours: false / rest of scene"}};
  VICTORIOUS_ASSIGN_OR_RETURN(const MatchTrial thesis, RunningExample(settings, ThesisSetup(), "jeep"));
  VICTORIOUS_ASSIGN_OR_RETURN(const MatchTrial ours, RunningExample(settings, DefaultSetup(), "jeep"));
  const StageMatches thesis_stages = RunStages(thesis, kTableRatio, ThesisSetup().recognize);
  const StageMatches our_stages = RunStages(ours, kTableRatio, DefaultSetup().recognize);
  PlotLine thesis_false{.name = "false, thesis's setting"};
  PlotLine our_false{.name = "false, ours"};
  PlotLine our_true{.name = "true, ours"};
  for (std::size_t stage = 0; stage < StageMatches::kNames.size(); ++stage) {
    std::vector<Cell> row = {std::string(StageMatches::kNames[stage])};
    if (stage < kThesis.size()) {
      for (const int count :
           {kThesis[stage].matches, kThesis[stage].correct, kThesis[stage].matches - kThesis[stage].correct})
        row.emplace_back(static_cast<double>(count));
    } else {
      row.insert(row.end(), 3, std::string());
    }
    const auto add = [&](const MatchTrial& trial, const MatchSet& matches) {
      const MatchCount count = trial.Count(matches);
      for (const int number : {count.matches, count.correct, count.FalseMatches()})
        row.emplace_back(static_cast<double>(number));
      row.emplace_back(fmt::format("{}/{}", count.correct, trial.Template().size()));
      row.emplace_back(fmt::format("{}/{}", count.FalseMatches(), trial.features->size() - trial.Template().size()));
      return count;
    };
    const MatchCount by_thesis = add(thesis, thesis_stages.sets[stage]);
    const MatchCount by_us = add(ours, our_stages.sets[stage]);
    const auto x = static_cast<double>(stage);
    thesis_false.points.push_back({x, static_cast<double>(by_thesis.FalseMatches())});
    our_false.points.push_back({x, static_cast<double>(by_us.FalseMatches())});
    our_true.points.push_back({x, static_cast<double>(by_us.correct)});
    report.rows.push_back(std::move(row));
  }
  report.notes = {
      fmt::format(
          "Here: {}; a match is true if its scene keypoint lies within {:g} px, or its own scale, of the projection "
          "of the template keypoint's 3-D point with the true pose, and false beyond {:g} px; the few between are "
          "neither.",
          ours.name, MatchTruth::kMinTolerancePx, MatchTruth::kNearPx),
      "Fractions refer to template keypoints, and to scene keypoints less template keypoints, as in the thesis. Its "
      "setting is `--params thesis`: Lowe's keypoints, no noise removal, table 3.1."};
  report.plot = {.title = "Matches left after each stage",
                 .x = {.label = "stages of the cascade, then MLESAC"},
                 .y = {.label = "matches"},
                 .lines = {thesis_false, our_false, our_true}};
  return report;
}

}  // namespace victorious

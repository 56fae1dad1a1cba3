// Filters and settings compared over the whole pool of trials: the fraction of true matches kept, and the fraction of
// false ones among the kept matches. Thresholds are learnt on the trials of every second flight and tested on the
// others.
#include <array>
#include <chrono>
#include <cmath>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "experiments/learn_thresholds.h"
#include "experiments/match_experiments.h"
#include "experiments/match_filters.h"
#include "experiments/match_pool.h"
#include "victorious/base/check.h"
#include "victorious/jobs/preset.h"

namespace victorious {
namespace {

constexpr int kFrames = 3;  // frames of each flight
constexpr std::array kRatios = {0.6, 0.7, 0.8, 0.85, 0.9, 0.95};

double Percent(double part, double whole) { return whole > 0 ? 100 * part / whole : 0; }

// The reduction factor of false matches. If none is left, only a lower bound: the number before.
Cell TimesFewer(int before, int after) {
  if (after > 0) return static_cast<double>(before) / after;
  return before > 0 ? fmt::format("> {}", before) : "-";
}

// The variants of the cascade that the thesis leaves open, in addition to MakeMatchFilters().
std::vector<MatchFilter> Variants(const CascadeOptions& cascade) {
  std::vector<MatchFilter> variants;
  const auto add = [&](std::string name, const auto& change) {
    CascadeOptions options = cascade;
    change(options);
    variants.push_back(MakeGrammarFilter(std::move(name), options));
  };
  add("cascade, R = 50 px", [](CascadeOptions& o) { o.radius_px = 50; });
  add("cascade, R = 100 px", [](CascadeOptions& o) { o.radius_px = 100; });
  for (const double share : {0.5, 0.7, 1.0}) {
    add(fmt::format("cascade, R from scale, share {:g}", share), [&](CascadeOptions& o) {
      o.radius = CascadeRadius::kScale;
      o.radius_fraction = share;
    });
  }
  add("cascade, support distinct nowhere", [](CascadeOptions& o) { o.distinct_stages = 0; });
  add("cascade, distinct in the last two stages", [](CascadeOptions& o) { o.distinct_stages = 2; });
  add("cascade, distinct in all stages", [](CascadeOptions& o) { o.distinct_stages = 3; });
  add("cascade, --params learnt", [](CascadeOptions& o) {
    RecognizeOptions options{.cascade = o};
    const Status applied = ApplyPreset(Preset::kLearnt, options);
    VICTORIOUS_CHECK(applied.has_value());
    o = options.cascade;
  });
  return variants;
}

struct Pooled {
  MatchCount before;
  MatchCount after;
  double ms = 0;  ///< mean per trial
};

Pooled RunFilter(const std::vector<const MatchTrial*>& trials, double ratio, const MatchFilter& filter) {
  Pooled pooled;
  for (const MatchTrial* trial : trials) {
    const MatchSet matches = trial->Matches(ratio);
    const auto start = std::chrono::steady_clock::now();
    const MatchSet left = filter.run(*trial, matches);
    pooled.ms += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count() /
                 static_cast<double>(trials.size());
    pooled.before += trial->Count(matches);
    pooled.after += trial->Count(left);
  }
  return pooled;
}

}  // namespace

Expected<Report> RunChapter3Filters(const ExperimentSettings& settings) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<PooledScene> scenes,
                              PoolScenes(settings, kFrames, IncludeMovies::kYes));
  Report report{
      .title = "True and false matches kept by the filters, all scenes pooled",
      .columns = {"setting", "trials", "ratio", "filter", "true before", "true kept %", "false before", "false after",
                  "near after", "false % of kept matches", "false before / after", "ms per trial"}};
  report.plot = {.title = "False among the kept matches, our setting",
                 .x = {.label = "ratio"},
                 .y = {.label = "false % of kept matches", .low = 0.1, .high = 100, .logarithmic = true}};
  for (const MatchSetup& setup : {ThesisSetup(), DefaultSetup()}) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<MatchTrial> trials, PoolTrials(settings, setup, scenes));
    std::vector<const MatchTrial*> all;
    std::vector<const MatchTrial*> learning;
    std::vector<const MatchTrial*> unseen;
    std::set<int> flights;  // flights so far; all trials of a flight go into the same half
    for (const MatchTrial& trial : trials) {
      flights.insert(trial.flight);
      all.push_back(&trial);
      (flights.size() % 2 == 1 ? learning : unseen).push_back(&trial);
    }
    const auto add = [&](const std::string& which, const std::vector<const MatchTrial*>& some, double ratio,
                         const MatchFilter& filter) {
      const Pooled pooled = RunFilter(some, ratio, filter);
      const double false_fraction = Percent(pooled.after.FalseMatches(), pooled.after.matches);
      report.rows.push_back(
          {setup.name, fmt::format("{} {}", which, some.size()), ratio, filter.name,
           static_cast<double>(pooled.before.correct), Percent(pooled.after.correct, pooled.before.correct),
           static_cast<double>(pooled.before.FalseMatches()), static_cast<double>(pooled.after.FalseMatches()),
           static_cast<double>(pooled.after.near), false_fraction,
           TimesFewer(pooled.before.FalseMatches(), pooled.after.FalseMatches()), pooled.ms});
      return false_fraction;
    };
    for (const MatchFilter& filter : MakeMatchFilters(setup.recognize)) {
      PlotLine line{.name = filter.name};
      for (const double ratio : kRatios) line.points.push_back({ratio, add("all", all, ratio, filter)});
      const bool is_plotted =
          filter.kind != MatchFilterKind::kSingleStage && filter.kind != MatchFilterKind::kOpenCvSimilarity;
      if (setup.kind == MatchSetup::Kind::kDefault && is_plotted) report.plot.lines.push_back(std::move(line));
      settings.progress(fmt::format("{}: {}", setup.name, filter.name));
    }
    for (const MatchFilter& filter : Variants(setup.recognize.cascade)) {
      for (const double ratio : {0.8, 0.95}) add("all", all, ratio, filter);
    }
    settings.progress(fmt::format("{}: learning thresholds", setup.name));
    CascadeOptions all_measures = setup.recognize.cascade;
    all_measures.all_measures = true;
    const std::array learnt = {
        std::pair{std::string("cascade, learnt thresholds"), LearnThresholds(learning, setup.recognize.cascade)},
        std::pair{std::string("cascade, learnt, all measures in each stage"), LearnThresholds(learning, all_measures)}};
    for (const double ratio : kRatios) {
      add("unseen", unseen, ratio, MakeGrammarFilter("cascade, table 3.1", setup.recognize.cascade));
      for (const auto& [name, options] : learnt) add("unseen", unseen, ratio, MakeGrammarFilter(name, options));
    }
    for (const auto& [name, options] : learnt) {
      report.notes.push_back(fmt::format(
          "Learnt on every second flight, setting {}, {}: scale {:.2f}, distance {:.2f}, orientation {:.2f} rad, line "
          "{:.2f} rad, approvals {:g}, {:g}, {:g}, votes {}.",
          setup.name, name, options.scale_distortion, options.distance_distortion, options.orientation_distortion_rad,
          options.line_distortion_rad, options.first_approval, options.second_approval, options.third_approval,
          options.min_votes));
    }
  }
  report.notes.push_back(
      "A trial: one image, one model with an object visible by 0.5 or more, the template of the nearest view.");
  return report;
}

}  // namespace victorious

// Figures 3.14 and 3.15: the number of matches of each view of the model after each stage, over the view sphere, as
// heat maps and as 3-D bars.
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "experiments/draw_matches.h"
#include "experiments/match_experiments.h"
#include "experiments/match_trial.h"
#include "experiments/view_grid.h"
#include "victorious/base/file.h"
#include "victorious/geometry/angles.h"
#include "victorious/input/image/image_file.h"
#include "victorious/input/image/montage.h"
#include "victorious/lab/evaluate/score.h"

namespace victorious {
namespace {

constexpr double kRatio = 0.8;
constexpr std::size_t kStages = 4;
constexpr int kColumns = kViewColumns;
constexpr int kRows = kViewRows;

struct ViewCounts {
  MatchTrial trial;                            ///< with the view nearest to the truth
  std::vector<std::array<int, kStages>> left;  ///< number of matches of each view after each stage
};

Expected<ViewCounts> CountViews(const ExperimentSettings& settings, const MatchSetup& setup, const std::string& kind) {
  VICTORIOUS_ASSIGN_OR_RETURN(const MatchTrial trial, RunningExample(settings, setup, kind));
  ViewCounts counts{.trial = trial, .left = {}};
  for (std::size_t view = 0; view < trial.model->views.size(); ++view) {
    VICTORIOUS_RETURN_IF_ERROR(settings.CheckCancelled());
    MatchTrial other = trial;
    other.view = view;
    const StageMatches stages = RunStages(other, kRatio, setup.recognize);
    std::array<int, kStages> left{};
    for (std::size_t stage = 0; stage < kStages; ++stage) left[stage] = static_cast<int>(stages.sets[stage].size());
    counts.left.push_back(left);
  }
  return counts;
}

double DegreesBetween(const ObjectModel& model, std::size_t a, std::size_t b) {
  if (a == b) return 0;
  return DegreesFromRadians(AngleBetween(*model.views[a].angles, *model.views[b].angles));
}

// The number of matches in each cell of the grid (view_grid.h).
cv::Mat GridOf(const ViewCounts& counts, std::size_t stage) {
  std::vector<double> values;
  for (const auto& left : counts.left) values.push_back(left[stage]);
  return MakeViewGrid(*counts.trial.model, values);
}

std::string StageCaption(std::size_t stage, double most) {
  return fmt::format("{}: at most {:.0f} matches", StageMatches::kNames[stage], most);
}

cv::Mat HeatMap(const ViewCounts& counts, std::size_t stage) {
  const cv::Mat grid = GridOf(counts, stage);
  double most = 1;
  cv::minMaxLoc(grid, nullptr, &most);
  const ViewDirection truth = *counts.trial.model->views[counts.trial.view].angles;
  return DrawHeatMap(grid, StageCaption(stage, most), {{truth}, cv::Scalar(80, 255, 80)});
}

// Draws bars on the grid of views in oblique projection, the farthest first.
cv::Mat Bars(const ViewCounts& counts, std::size_t stage) {
  constexpr double kStepX = 7;
  constexpr double kStepY = 8;
  constexpr double kSlant = 4;
  constexpr double kHighest = 110;
  constexpr int kTop = 40;
  const cv::Mat grid = GridOf(counts, stage);
  double most = 1;
  cv::minMaxLoc(grid, nullptr, &most);
  const int width = static_cast<int>(kColumns * kStepX + kRows * kSlant) + 20;
  cv::Mat image(kTop + static_cast<int>(kHighest + kRows * kStepY) + 10, width, CV_8UC3, cv::Scalar::all(255));
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      const double share = grid.at<float>(row, column) / std::max(most, 1.0);
      const double x = 10 + column * kStepX + (kRows - row) * kSlant;
      const double foot = kTop + kHighest + row * kStepY + kStepY;
      cv::Mat level(1, 1, CV_8UC1, cv::Scalar(255 * share));
      cv::Mat colour;
      cv::applyColorMap(level, colour, cv::COLORMAP_INFERNO);
      const cv::Vec3b bgr = colour.at<cv::Vec3b>(0);
      const cv::Rect bar(cv::Point2d(x, foot - share * kHighest - 2), cv::Point2d(x + kStepX - 2, foot));
      cv::rectangle(image, bar, cv::Scalar(bgr[0], bgr[1], bgr[2]), cv::FILLED);
      cv::rectangle(image, bar, cv::Scalar::all(200));
    }
  }
  DrawCaption(image, StageCaption(stage, most));
  return image;
}

template <typename Draw>
Status WriteStages(const std::filesystem::path& path, const ViewCounts& counts, const Draw& draw) {
  // Clockwise from the upper left corner, as in the thesis.
  return WriteImage(path, Montage({draw(counts, 0), draw(counts, 1), draw(counts, 3), draw(counts, 2)}, 2));
}

struct StageRanking {
  int rank = 1;          ///< rank of the true view
  int tied = 0;          ///< number of other views with as many matches
  std::size_t best = 0;  ///< view with the maximum number of matches
  int best_count = 0;
  int true_count = 0;
  int max_far_count = 0;  ///< maximum number of matches of the views more than 40 degrees away
};

StageRanking Rank(const ViewCounts& counts, std::size_t stage) {
  constexpr double kFarDegrees = 40;
  StageRanking ranking;
  ranking.true_count = counts.left[counts.trial.view][stage];
  for (std::size_t view = 0; view < counts.left.size(); ++view) {
    const int count = counts.left[view][stage];
    if (count > ranking.true_count) ++ranking.rank;
    if (count == ranking.true_count && view != counts.trial.view) ++ranking.tied;
    if (count > ranking.best_count) {
      ranking.best_count = count;
      ranking.best = view;
    }
    if (DegreesBetween(*counts.trial.model, view, counts.trial.view) > kFarDegrees)
      ranking.max_far_count = std::max(ranking.max_far_count, count);
  }
  return ranking;
}

std::string CsvOfViews(const ViewCounts& counts) {
  std::string csv = "azimuth_deg,off_nadir_deg,none,first,second,third\n";
  for (std::size_t view = 0; view < counts.left.size(); ++view) {
    const ViewDirection& angles = *counts.trial.model->views[view].angles;
    const auto& left = counts.left[view];
    csv += fmt::format("{:.0f},{:.0f},{},{},{},{}\n", DegreesFromRadians(angles.azimuth_rad),
                       DegreesFromRadians(angles.off_nadir_rad), left[0], left[1], left[2], left[3]);
  }
  return csv;
}

}  // namespace

Expected<Report> RunFigure314(const ExperimentSettings& settings) {
  Report report{.title = "Rank of the true view among all 253, by number of matches at a ratio of 0.8",
                .columns = {"object", "setting", "filtering", "rank of the true view", "tied views",
                            "matches of true view", "most matches", "best view error (degrees)"}};
  PlotLine thesis_line{.name = "thesis's setting"};
  PlotLine our_line{.name = "ours"};
  for (const char* kind : {"jeep", "jet"}) {
    for (const MatchSetup& setup : {ThesisSetup(), DefaultSetup()}) {
      VICTORIOUS_ASSIGN_OR_RETURN(const ViewCounts counts, CountViews(settings, setup, kind));
      const bool shown = std::string_view(kind) == "jeep" && setup.kind == MatchSetup::Kind::kDefault;
      if (shown) {
        VICTORIOUS_RETURN_IF_ERROR(WriteStages(settings.out / "figure3.14.png", counts, HeatMap));
        VICTORIOUS_RETURN_IF_ERROR(WriteFileAtomically(settings.out / "figure3.14.views.csv", CsvOfViews(counts)));
      }
      for (std::size_t stage = 0; stage < kStages; ++stage) {
        const StageRanking ranking = Rank(counts, stage);
        report.rows.push_back({std::string(kind), setup.name, std::string(StageMatches::kNames[stage]),
                               static_cast<double>(ranking.rank), static_cast<double>(ranking.tied),
                               static_cast<double>(ranking.true_count), static_cast<double>(ranking.best_count),
                               DegreesBetween(*counts.trial.model, ranking.best, counts.trial.view)});
        if (std::string_view(kind) == "jeep")
          (setup.kind == MatchSetup::Kind::kDefault ? our_line : thesis_line)
              .points.push_back({static_cast<double>(stage), static_cast<double>(ranking.rank)});
      }
    }
  }
  report.notes = {
      "Thesis: the true view is ranked first after the first stage, but not without filtering. The image: jeep, "
      "our setting, clockwise from the upper left corner none, first, second, third; azimuth to the right from "
      "0, off-nadir angle downwards from 0 to 70 degrees, the true view highlighted green."};
  report.plot = {.title = "Rank of the true view of the jeep among 253",
                 .x = {.label = "stages of the cascade"},
                 .y = {.label = "rank"},
                 .lines = {thesis_line, our_line}};
  return report;
}

Expected<Report> RunFigure315(const ExperimentSettings& settings) {
  Report report{.title = "Matches of all views as bars: the peak at the true view and spurious peaks far from it",
                .columns = {"object", "filtering", "matches of the true view", "max of views over 40 degrees away",
                            "peak to spurious peak"}};
  for (const char* kind : {"jeep", "jet"}) {
    VICTORIOUS_ASSIGN_OR_RETURN(const ViewCounts counts, CountViews(settings, DefaultSetup(), kind));
    if (std::string_view(kind) == "jeep")
      VICTORIOUS_RETURN_IF_ERROR(WriteStages(settings.out / "figure3.15.png", counts, Bars));
    PlotLine line{.name = kind};
    for (std::size_t stage = 0; stage < kStages; ++stage) {
      const StageRanking ranking = Rank(counts, stage);
      const double ratio = ranking.true_count / std::max(1.0, static_cast<double>(ranking.max_far_count));
      report.rows.push_back({std::string(kind), std::string(StageMatches::kNames[stage]),
                             static_cast<double>(ranking.true_count), static_cast<double>(ranking.max_far_count),
                             ratio});
      line.points.push_back({static_cast<double>(stage), ratio});
    }
    report.plot.lines.push_back(std::move(line));
  }
  report.notes = {
      "Our setting. The image: the jeep's views, clockwise from the upper left corner none, first, second, third "
      "stage; azimuth to the right, the pole at the back."};
  report.plot.title = "Matches of the true view over the maximum of the views more than 40 degrees away";
  report.plot.x = {.label = "stages of the cascade"};
  report.plot.y = {.label = "peak to spurious peak"};
  return report;
}

}  // namespace victorious

// Table 5.1: running time of each step of a frame, and of a whole frame with 25 models.
#include <algorithm>
#include <array>
#include <cstddef>
#include <filesystem>
#include <numeric>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "experiments/indexed_movie.h"
#include "experiments/system_experiments.h"
#include "victorious/base/stage_time.h"
#include "victorious/jobs/index/indexer.h"

namespace victorious {
namespace {

constexpr double kModels = 25;  // of the total

// A row of the thesis's table, s, and the stages of the program that do the same.
struct ProgramStep {
  const char* name;
  bool per_model;
  std::optional<std::array<double, 4>> thesis_s;  // current, GPU, 15 degree interval, four Tesla cards
  std::vector<Stage> stages;
};

const std::array<ProgramStep, 7>& ProgramSteps() {
  static const std::array<ProgramStep, 7> steps = {{
      {"feature extraction", false, {{1.6678, 0.04, 0.04, 0.0066}}, {Stage::kFeatures}},
      {"matching", true, {{0.0274, 0.0274, 0.0122, 0.0005}}, {Stage::kMatching}},
      {"constraints (the cascade; ours: votes, MLESAC and significance)",
       true,
       {{0.1797, 0.0019, 0.0008, 0.000033}},
       {Stage::kPoses}},
      {"RANSAC (ours: in the row above)", true, {{0.0795, 0.0007, 0.0007, 0.000029}}, {}},
      {"templates for the sun's direction", true, {}, {Stage::kRelitTemplates}},
      {"tracking", true, {{0.0986, 0.0099, 0.0099, 0.0004}}, {Stage::kTracking}},
      {"rest (ours: reading, detection, rescoring, store)",
       true,
       {{0.0011, 0.0001, 0.0001, 0.000004}},
       {Stage::kReading, Stage::kDetection, Stage::kNcc, Stage::kStore}},
  }};
  return steps;
}

// Processor time per frame, s, of one index.
struct FrameTimes {
  std::array<double, kStageCount> stages_s;
  double frames = 0;
  double sightings = 0;
};

Expected<FrameTimes> TimeFrames(const MovieWithTruth& movie, SearchMethod method, const ExperimentSettings& settings) {
  IndexOptions options;
  options.recognize.method = method;
  VICTORIOUS_ASSIGN_OR_RETURN(const Indexer indexer, Indexer::Create(movie.models, options));
  const std::filesystem::path folder = settings.out / "indexes" / "table5.1";
  std::error_code error;
  std::filesystem::remove_all(folder, error);  // of an interrupted run
  if (!error) std::filesystem::create_directories(folder, error);
  if (error) return std::unexpected(ErrorFromErrno(error.value(), "make folder " + folder.string()));
  VICTORIOUS_ASSIGN_OR_RETURN(auto store, OpenSqliteStore(folder / "index.db", StoreMode::kCreate));
  const IndexJob job{.video = (movie.folder / "video.mp4").string(),
                     .telemetry = (movie.folder / "telemetry.csv").string(),
                     .threads = 1};
  MeasureStages(true);
  VICTORIOUS_ASSIGN_OR_RETURN(const IndexReport report, indexer.Index(job, settings.Cancel(), *store));
  FrameTimes times{.stages_s = StageTimes()};
  MeasureStages(false);
  store.reset();
  std::filesystem::remove_all(folder, error);
  times.frames = static_cast<double>(report.frames_searched);
  times.sightings = static_cast<double>(report.sightings);
  for (double& stage_s : times.stages_s) stage_s /= std::max(1.0, times.frames);
  return times;
}

double SumOf(const std::vector<Stage>& stages, const FrameTimes& times) {
  return std::accumulate(stages.begin(), stages.end(), 0.0, [&](double sum, Stage stage) {
    return sum + times.stages_s[static_cast<std::size_t>(stage)];
  });
}

}  // namespace

Expected<Report> RunTable51(const ExperimentSettings& settings) {
  ExperimentSettings few = settings;
  if (few.frames == 0) few.frames = 20;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<MovieWithTruth> movies, SimulateScenes({"straight"}, few));
  const MovieWithTruth& movie = movies.front();
  VICTORIOUS_ASSIGN_OR_RETURN(const FrameTimes votes, TimeFrames(movie, SearchMethod::kVotes, settings));
  VICTORIOUS_ASSIGN_OR_RETURN(const FrameTimes shortlist, TimeFrames(movie, SearchMethod::kShortlist, settings));
  const auto models = static_cast<double>(movie.models.size());

  Report report{
      .title = "Running time, seconds of processor time a frame",
      .notes = {fmt::format("Ours: {}, {} models of {} views, every frame searched as a whole on one thread; the start "
                            "of the video (the sun's direction) is not included.",
                            DescribeMovies(movies), movie.models.size(), movie.models.front().views.size()),
                fmt::format("Sightings in {} frames: {} by votes, {} by shortlist.", votes.frames, votes.sightings,
                            shortlist.sightings),
                "The thesis measured its first column on a 3.0 GHz dual-core processor with a GPU, and predicted the "
                "other three. Its total is the extraction plus 25 times the steps of a model; so is ours."},
      .columns = {"step", "of", "thesis", "thesis: GPU", "thesis: 15 degrees", "thesis: four Tesla", "ours: votes",
                  "ours: shortlist"}};
  std::array<double, 6> total_s{};
  for (const ProgramStep& step : ProgramSteps()) {
    std::vector<Cell> row = {std::string(step.name), std::string(step.per_model ? "model" : "frame")};
    const double divisor = step.per_model ? models : 1;
    const double factor = step.per_model ? kModels : 1;
    for (std::size_t i = 0; i < 4; ++i) {
      row.push_back(step.thesis_s ? Cell((*step.thesis_s)[i]) : Cell(std::string()));
      total_s[i] += step.thesis_s ? factor * (*step.thesis_s)[i] : 0;
    }
    for (std::size_t i = 0; i < 2; ++i) {
      const double time_s = SumOf(step.stages, i == 0 ? votes : shortlist) / divisor;
      row.push_back(step.stages.empty() ? Cell(std::string()) : Cell(time_s));
      total_s[4 + i] += factor * time_s;
    }
    report.rows.push_back(std::move(row));
  }
  std::vector<Cell> total = {fmt::format("total, {} models", kModels), std::string("frame")};
  total.insert(total.end(), total_s.begin(), total_s.end());
  report.rows.push_back(std::move(total));
  return report;
}

}  // namespace victorious

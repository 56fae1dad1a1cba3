// The shortlist search beside the vote search, which is its definition: the sightings that proposals lose, and what
// they cost, on single frames of the movies with ground truth. docs/adr/0018 uses the table.
#include <algorithm>
#include <functional>
#include <iterator>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "experiments/indexed_movie.h"
#include "experiments/movie_search.h"
#include "experiments/recognition_experiments.h"
#include "experiments/video_frames.h"
#include "victorious/base/stage_time.h"
#include "victorious/input/image/impulse_noise.h"
#include "victorious/input/telemetry/camera_track.h"
#include "victorious/input/video/video_reader.h"
#include "victorious/lab/evaluate/score.h"
#include "victorious/object/model/relit_views.h"
#include "victorious/place/calibrate/sun_direction.h"
#include "victorious/place/cameras/video_telemetry.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;

constexpr int kMovieFrames = 12;  // of each movie, unless the settings say otherwise

// One search to compare; the first one is the definition.
struct ShortlistSetting {
  std::string name;
  SearchMethod method = SearchMethod::kShortlist;
  ShortlistOptions shortlist = {};
};

std::vector<ShortlistSetting> MakeSettings() {
  const auto with = [](std::string name, const std::function<void(ShortlistOptions&)>& change) {
    ShortlistSetting setting{.name = std::move(name)};
    change(setting.shortlist);
    return setting;
  };
  return {{"votes", SearchMethod::kVotes},
          {"shortlist"},
          with("one nearest", [](ShortlistOptions& options) { options.nearest = 1; }),
          with("two refined, two verified",
               [](ShortlistOptions& options) { options.max_refined = options.max_verified = 2; }),
          with("sixteen refined, 24 verified",
               [](ShortlistOptions& options) {
                 options.max_refined = 16;
                 options.max_verified = 24;
               }),
          with("any significance", [](ShortlistOptions& options) {
            options.min_refined_neg_log10_nfa = options.min_verified_neg_log10_nfa = -100;
          })};
}

// What one search found and took, over all frames.
struct Tally {
  int true_sightings = 0;
  int false_sightings = 0;
  int lost = 0;    ///< true sightings of the first search that this one lacks
  int gained = 0;  ///< true sightings that only this one has
  double matching_s = 0;
  double poses_s = 0;
};

struct MovieFrames {
  std::vector<Frame> frames;
  CameraTrajectory cameras;
  std::optional<Sun> sun;
};

Expected<MovieFrames> ReadMovieFrames(const fs::path& folder, const Recognizer& recognizer,
                                      const FeatureExtractor& extractor, const ExperimentSettings& settings) {
  const fs::path video = folder / "video.mp4";
  const IndexOptions options;
  VICTORIOUS_ASSIGN_OR_RETURN(Telemetry telemetry,
                              ReadTelemetry((folder / "telemetry.csv").string(), options.telemetry));
  MovieFrames all{.frames = {}, .cameras = CameraTrajectory(std::move(telemetry.states), options.telemetry.max_gap_s)};
  settings.progress(fmt::format("{}: estimating the sun's direction", folder.filename().string()));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, VideoReader::Open(video.string(), {}));
  VICTORIOUS_ASSIGN_OR_RETURN(
      all.sun,
      EstimateSunDirection({all.cameras, recognizer, extractor, options.sun_direction}, *reader, settings.Cancel(),
                           [&](const std::string& warning) { settings.progress(warning); }));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t length, CountFrames(video));
  const int count = settings.frames > 0 ? settings.frames : kMovieFrames;
  VICTORIOUS_ASSIGN_OR_RETURN(all.frames, ReadNumberedFrames(video, EvenlySpaced(length, count), FrameColor::kGrey));
  return all;
}

// Adds the detections of one frame; returns the truth rows that they show.
std::set<std::size_t> CountDetections(std::span<const TruthRow> rows, const std::vector<ObjectModel>& models,
                                      std::int64_t frame, std::span<const Detection> detections, Tally& tally) {
  std::vector<ReportedSighting> sightings;
  for (const Detection& detection : detections) {
    sightings.push_back({.frame = frame,
                         .model = models[detection.model_index].name,
                         .box = detection.box,
                         .score = detection.score,
                         .view = {}});
  }
  std::set<std::size_t> shown;
  for (const std::optional<std::size_t>& row : PairSightings(rows, sightings)) {
    if (row) {
      shown.insert(*row);
      ++tally.true_sightings;
    } else {
      ++tally.false_sightings;
    }
  }
  return shown;
}

int CountMissing(const std::set<std::size_t>& from, const std::set<std::size_t>& in) {
  return static_cast<int>(std::ranges::count_if(from, [&](std::size_t row) { return !in.contains(row); }));
}

Expected<std::vector<Tally>> SearchFrames(const std::string& movie, std::span<const TruthRow> truth,
                                          const MovieFrames& all, std::span<const Recognizer> recognizers,
                                          const FeatureExtractor& extractor, const ExperimentSettings& settings) {
  std::vector<Tally> tallies(recognizers.size());
  for (const Frame& frame : all.frames) {
    VICTORIOUS_RETURN_IF_ERROR(settings.CheckCancelled());
    settings.progress(fmt::format("{}: frame {}", movie, frame.index));
    VICTORIOUS_ASSIGN_OR_RETURN(const FeatureSet features, extractor.Extract(frame.image));
    const cv::Mat clean = RemoveImpulses(frame.image, kDefaultImpulseFraction);
    const FrameConditions conditions = MakeFrameConditions(all.cameras.At(frame.time_s), frame.image.size(), all.sun);
    std::vector<TruthRow> rows;
    std::ranges::copy_if(truth, std::back_inserter(rows),
                         [&](const TruthRow& row) { return row.frame == frame.index; });
    std::set<std::size_t> exact;
    for (std::size_t i = 0; i < recognizers.size(); ++i) {
      MeasureStages(true);
      VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<Detection> detections,
                                  recognizers[i].Recognize(features, conditions, clean));
      MeasureStages(false);
      Tally& tally = tallies[i];
      tally.matching_s += StageTimes()[static_cast<std::size_t>(Stage::kMatching)];
      tally.poses_s += StageTimes()[static_cast<std::size_t>(Stage::kPoses)];
      const std::set<std::size_t> shown =
          CountDetections(rows, recognizers[i].models(), frame.index, detections, tally);
      if (i == 0) exact = shown;
      tally.lost += CountMissing(exact, shown);
      tally.gained += CountMissing(shown, exact);
    }
  }
  return tallies;
}

std::vector<Cell> MakeRow(const std::string& movie, const std::string& setting, const Tally& tally, double frames) {
  constexpr double kMsPerS = 1e3;
  return {movie,
          setting,
          static_cast<double>(tally.true_sightings),
          static_cast<double>(tally.false_sightings),
          static_cast<double>(tally.lost),
          static_cast<double>(tally.gained),
          kMsPerS * tally.matching_s / frames,
          kMsPerS * tally.poses_s / frames};
}

}  // namespace

Expected<Report> RunTableShortlist(const ExperimentSettings& settings) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<fs::path> folders, FindMovies(settings));
  std::vector<TruthRow> every_row;
  for (const fs::path& folder : folders) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<TruthRow> truth, ReadTruth(folder / "truth.jsonl"));
    every_row.insert(every_row.end(), truth.begin(), truth.end());
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ObjectModel> models,
                              LoadTruthModels(every_row, settings.data / "models", settings));
  std::vector<std::shared_ptr<const RelitTemplateSource>> relit;
  for (const ObjectModel& model : models) {
    VICTORIOUS_ASSIGN_OR_RETURN(relit.emplace_back(), MakeRelitViews(model));
  }
  IndexOptions options;
  VICTORIOUS_ASSIGN_OR_RETURN(const auto extractor, MakeFeatureExtractor(options.features));
  const std::vector<ShortlistSetting> compared = MakeSettings();
  std::vector<Recognizer> recognizers;
  for (const ShortlistSetting& setting : compared) {
    options.recognize.method = setting.method;
    options.recognize.shortlist = setting.shortlist;
    VICTORIOUS_ASSIGN_OR_RETURN(Recognizer recognizer,
                                Recognizer::Create(models, options.features.engine, options.recognize, relit));
    recognizers.push_back(std::move(recognizer));
  }
  Report report{.title = fmt::format("The shortlist search beside the vote search, {} models", models.size()),
                .columns = {"movie", "search", "true sightings", "false", "lost", "gained", "matching, ms/frame",
                            "votes and poses, ms/frame"}};
  for (const fs::path& folder : folders) {
    const std::string name = folder.filename().string();
    if (!settings.movies.empty() && std::ranges::find(settings.movies, name) == settings.movies.end()) continue;
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<TruthRow> truth, ReadTruth(folder / "truth.jsonl"));
    VICTORIOUS_ASSIGN_OR_RETURN(const MovieFrames all,
                                ReadMovieFrames(folder, recognizers.front(), *extractor, settings));
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<Tally> tallies,
                                SearchFrames(name, truth, all, recognizers, *extractor, settings));
    for (std::size_t i = 0; i < compared.size(); ++i) {
      report.rows.push_back(MakeRow(name, compared[i].name, tallies[i], static_cast<double>(all.frames.size())));
    }
  }
  report.notes = {
      "Frames evenly spaced over each movie, searched one by one for the models of all movies. Each model is searched "
      "independently, so times grow with their number. Processor time without the features, the relit templates and "
      "the rescoring, which are the same for all."};
  return report;
}

}  // namespace victorious

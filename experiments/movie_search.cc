#include "experiments/movie_search.h"

#include <algorithm>
#include <cstdio>
#include <memory>
#include <utility>

#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>

#include "experiments/indexed_movie.h"
#include "experiments/video_frames.h"
#include "victorious/base/folder.h"
#include "victorious/input/image/impulse_noise.h"
#include "victorious/input/video/video_reader.h"
#include "victorious/lab/evaluate/score.h"
#include "victorious/object/model/relit_views.h"
#include "victorious/place/cameras/video_telemetry.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;

// Everything that the search of a movie needs.
struct SearchContext {
  std::unique_ptr<const FeatureExtractor> extractor;
  Recognizer recognizer;
  std::optional<CameraTrajectory> cameras;
  std::optional<Sun> sun;
  std::vector<TruthRow> truth;
};

Expected<SearchContext> Prepare(const MovieSearch& search, const ExperimentSettings& settings) {
  const IndexOptions& options = search.options;
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<TruthRow> truth, ReadTruth(search.movie / "truth.jsonl"));
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<ObjectModel> models,
                              LoadTruthModels(truth, settings.data / "models", settings));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto relit_templates, MakeRelitViews(models));
  VICTORIOUS_ASSIGN_OR_RETURN(auto extractor, MakeFeatureExtractor(options.features));
  VICTORIOUS_ASSIGN_OR_RETURN(Recognizer recognizer, Recognizer::Create(std::move(models), options.features.engine,
                                                                        options.recognize, relit_templates));
  std::optional<CameraTrajectory> cameras;
  std::optional<Sun> sun;
  if (const fs::path path = search.movie / "telemetry.csv"; fs::exists(path)) {
    VICTORIOUS_ASSIGN_OR_RETURN(Telemetry telemetry, ReadTelemetry(path.string(), options.telemetry));
    cameras.emplace(std::move(telemetry.states), options.telemetry.max_gap_s);
    VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, VideoReader::Open((search.movie / "video.mp4").string(), {}));
    VICTORIOUS_ASSIGN_OR_RETURN(
        sun, EstimateSunDirection({*cameras, recognizer, *extractor, options.sun_direction}, *reader, settings.Cancel(),
                                  [](const std::string& warning) { fmt::print(stderr, "warning: {}\n", warning); }));
  }
  return SearchContext{std::move(extractor), std::move(recognizer), std::move(cameras), sun, std::move(truth)};
}

// Pairs each detection of the frame with a truth row.
std::vector<std::optional<TruthRow>> PairDetections(const SearchContext& search, const SearchedFrame& searched) {
  std::vector<TruthRow> rows;
  std::ranges::copy_if(search.truth, std::back_inserter(rows),
                       [&](const TruthRow& row) { return row.frame == searched.frame; });
  std::vector<ReportedSighting> sightings;
  for (const Detection& detection : searched.detections) {
    sightings.push_back({.frame = searched.frame,
                         .model = search.recognizer.models()[detection.model_index].name,
                         .box = detection.box,
                         .score = detection.score,
                         .view = {}});
  }
  std::vector<std::optional<TruthRow>> paired;
  for (const std::optional<std::size_t>& row : PairSightings(rows, sightings)) {
    paired.push_back(row ? std::optional(rows[*row]) : std::nullopt);
  }
  return paired;
}

Expected<SearchedFrame> SearchFrame(const SearchContext& search, const Frame& frame) {
  SearchedFrame searched{.frame = frame.index};
  if (search.cameras) searched.camera = search.cameras->At(frame.time_s);
  searched.conditions = MakeFrameConditions(searched.camera, frame.image.size(), search.sun);
  VICTORIOUS_ASSIGN_OR_RETURN(searched.features, search.extractor->Extract(frame.image));
  VICTORIOUS_ASSIGN_OR_RETURN(searched.detections,
                              search.recognizer.Recognize(searched.features, searched.conditions,
                                                          RemoveImpulses(frame.image, kDefaultImpulseFraction)));
  searched.truth = PairDetections(search, searched);
  return searched;
}

}  // namespace

Expected<std::vector<fs::path>> FindMovies(const ExperimentSettings& settings) {
  std::vector<fs::path> movies;
  for (const fs::path& folder : ListFolder(settings.data / "movies").value_or(std::vector<fs::path>())) {
    std::error_code absent;
    if (fs::exists(folder / "truth.jsonl", absent)) movies.push_back(folder);
  }
  if (movies.empty()) {
    return Fail(ErrorCode::kNotFound,
                fmt::format("{}: no movies: expected folders with video.mp4, telemetry.csv and truth.jsonl",
                            (settings.data / "movies").string()));
  }
  return movies;
}

Status SearchMovie(const MovieSearch& search, const ExperimentSettings& settings,
                   const std::function<Status(const SearchedFrame&, const std::vector<ObjectModel>&)>& visit) {
  const std::string name = search.movie.filename().string();
  VICTORIOUS_ASSIGN_OR_RETURN(const SearchContext prepared, Prepare(search, settings));
  const fs::path video = search.movie / "video.mp4";
  VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t length, CountFrames(video));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<Frame> frames,
                              ReadNumberedFrames(video, EvenlySpaced(length, search.frames), FrameColor::kGrey));
  constexpr std::size_t kBatch = 4;  // frames between reports of progress
  for (std::size_t first = 0; first < frames.size(); first += kBatch) {
    VICTORIOUS_RETURN_IF_ERROR(settings.CheckCancelled());
    settings.progress(fmt::format("{}: {} of {} frames", name, first, frames.size()));
    const std::size_t count = std::min(kBatch, frames.size() - first);
    std::vector<Expected<SearchedFrame>> batch(count);
    oneapi::tbb::parallel_for(std::size_t{0}, count,
                              [&](std::size_t i) { batch[i] = SearchFrame(prepared, frames[first + i]); });
    for (Expected<SearchedFrame>& searched : batch) {
      if (!searched) return std::unexpected(std::move(searched).error());
      searched->movie = name;
      VICTORIOUS_RETURN_IF_ERROR(visit(*searched, prepared.recognizer.models()));
    }
  }
  return {};
}

}  // namespace victorious

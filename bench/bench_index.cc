// An index of CAD models as a whole: some consecutive frames from the middle of a movie, each searched as a whole and
// tracked, on one thread. The parts of the processor time are measured by base/stage_time.h.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <ctime>
#include <filesystem>
#include <functional>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <opencv2/features2d.hpp>

#include "bench/benchmarks.h"
#include "bench/index_input.h"
#include "testing/data.h"
#include "victorious/base/median.h"
#include "victorious/base/stage_time.h"
#include "victorious/jobs/index/index_pass.h"
#include "victorious/lab/evaluate/score.h"
#include "victorious/object/model/relit_views.h"
#include "victorious/place/calibrate/sun_direction.h"
#include "victorious/store/index_store.h"

namespace victorious::bench {
namespace {

constexpr std::array<std::size_t, 2> kModelCounts = {4, 25};
constexpr std::int64_t kFrames = 6;
constexpr std::int64_t kFramesByDefault = 100;  // the fewest with a 99th percentile

double ProcessTimeMs() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

// Of the frames that were searched as a whole: none of the others takes as long.
double MeanOfLongest(std::vector<double> times_ms, std::int64_t count) {
  std::ranges::sort(times_ms, std::greater());
  const auto end = times_ms.begin() + std::clamp<std::int64_t>(count, 1, std::ssize(times_ms));
  return std::accumulate(times_ms.begin(), end, 0.0) / static_cast<double>(end - times_ms.begin());
}

// The frames [first, first + count) of a reader. Those before it are decoded by the constructor. On one thread a frame
// passes all stages before the next one is read, so that the processor time between two calls is that of a frame.
class Clip final : public VideoReader {
 public:
  static Expected<std::unique_ptr<Clip>> Open(const std::string& video, std::int64_t count) {
    VICTORIOUS_ASSIGN_OR_RETURN(auto reader, VideoReader::Open(video, {.threads = 1}));
    const std::int64_t frames = reader->info().frame_count.value_or(0);
    const std::int64_t first = std::max<std::int64_t>(0, (frames - count) / 2);
    for (std::int64_t i = 0; i < first; ++i) VICTORIOUS_RETURN_IF_ERROR(Discard(reader->NextFrame()));
    return std::unique_ptr<Clip>(new Clip(std::move(reader), count));
  }

  [[nodiscard]] const VideoInfo& info() const override { return reader_->info(); }
  [[nodiscard]] Expected<std::string> ContentId(const CancelToken& cancel,
                                                const ByteProgress& progress) const override {
    return reader_->ContentId(cancel, progress);
  }
  Expected<std::optional<Frame>> NextFrame() override {
    times_ms_.push_back(ProcessTimeMs());
    if (left_ == 0) return std::nullopt;
    --left_;
    Expected<std::optional<Frame>> frame = reader_->NextFrame();
    if (frame && *frame) frames_.push_back((*frame)->image.clone());
    return frame;
  }
  std::vector<DataPacket> TakeDataPackets() override { return reader_->TakeDataPackets(); }
  bool SeekTo(double time_s) override { return reader_->SeekTo(time_s); }
  void SkipToEnd() override { left_ = 0; }
  [[nodiscard]] const std::vector<std::string>& warnings() const override { return reader_->warnings(); }

  [[nodiscard]] const std::vector<cv::Mat>& frames() const { return frames_; }
  // Processor time of each frame.
  [[nodiscard]] std::vector<double> FrameTimesMs() const {
    std::vector<double> times_ms(times_ms_.size());
    std::adjacent_difference(times_ms_.begin(), times_ms_.end(), times_ms.begin());
    if (!times_ms.empty()) times_ms.erase(times_ms.begin());
    return times_ms;
  }

 private:
  Clip(std::unique_ptr<VideoReader> reader, std::int64_t count) : reader_(std::move(reader)), left_(count) {}

  static Status Discard(Expected<std::optional<Frame>> frame) {
    if (!frame) return std::unexpected(std::move(frame).error());
    return {};
  }

  std::unique_ptr<VideoReader> reader_;
  std::int64_t left_;
  std::vector<double> times_ms_;
  std::vector<cv::Mat> frames_;
};

// Median processor time of cv::SIFT with the options of the search.
double OpenCvSiftMs(const std::vector<cv::Mat>& frames, const FeatureOptions& options) {
  constexpr int kLayers = 3;
  constexpr double kSigma_px = 1.6;
  std::vector<double> times_ms;
  for (const cv::Mat& frame : frames) {
    const double start_ms = ProcessTimeMs();
    std::vector<cv::KeyPoint> keypoints;
    cv::Mat descriptors;
    cv::SIFT::create(0, kLayers, options.contrast_threshold, options.edge_threshold, kSigma_px)
        ->detectAndCompute(frame, cv::noArray(), keypoints, descriptors);
    times_ms.push_back(ProcessTimeMs() - start_ms);
  }
  return Median(std::move(times_ms));
}

// The records that a pass needs, in a new index.
struct PassRecords {
  std::unique_ptr<IndexStore> store;
  VideoRecord video;
  std::vector<SearchRecord> searches;
};

Expected<PassRecords> MakeRecords(const std::filesystem::path& index, const std::string& video, const VideoInfo& info,
                                  std::span<const ObjectModel> models) {
  PassRecords records;
  VICTORIOUS_ASSIGN_OR_RETURN(records.store, OpenSqliteStore(index, StoreMode::kCreate));
  VICTORIOUS_ASSIGN_OR_RETURN(
      records.video,
      records.store->PutVideo({.content_id = video, .name = video, .width = info.width, .height = info.height}));
  for (const ObjectModel& model : models) {
    VICTORIOUS_ASSIGN_OR_RETURN(
        const ModelRecord stored,
        records.store->PutModel({.name = model.name, .content_id = model.id, .kind = model.kind}));
    records.searches.push_back({.video = records.video.id, .model = stored.id, .options_json = "{}"});
  }
  return records;
}

// How often a movie is searched as a whole.
enum class Schedule {
  kEachFrame,  // for all views, where the image has moved
  kDefault,    // of `victorious index`
};

// @param folder  of relit templates that were made before
Expected<Result> TimeIndex(const IndexMovie& movie, const std::vector<ObjectModel>& models, std::int64_t frames,
                           Schedule schedule, const RelitTemplateFolder& folder) {
  const IndexOptions options;
  const std::string video = (movie.folder / "video.mp4").string();
  const auto ignore = [](const std::string&) {};
  VICTORIOUS_ASSIGN_OR_RETURN(const auto extractor, MakeFeatureExtractor(options.features));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto relit, MakeRelitViews(models, &folder));
  VICTORIOUS_ASSIGN_OR_RETURN(const Recognizer recognizer,
                              Recognizer::Create(models, options.features.engine, options.recognize, relit));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto whole, VideoReader::Open(video, {.threads = 1}));
  VICTORIOUS_ASSIGN_OR_RETURN(CameraStates cameras,
                              CameraStates::Load(video, whole->info(), (movie.folder / "telemetry.csv").string(),
                                                 options.telemetry, "no sun", ignore));

  MeasureStages(true);
  std::optional<Sun> sun;
  if (cameras.trajectory() != nullptr) {
    VICTORIOUS_ASSIGN_OR_RETURN(
        sun, EstimateSunDirection({*cameras.trajectory(), recognizer, *extractor, options.sun_direction, 1}, *whole,
                                  CancelToken(), ignore));
  }
  const std::array<double, kStageCount> start_s = StageTimes();

  VICTORIOUS_ASSIGN_OR_RETURN(const std::unique_ptr<Clip> clip, Clip::Open(video, frames));
  const testing::ScratchFolder scratch;
  VICTORIOUS_ASSIGN_OR_RETURN(const PassRecords records,
                              MakeRecords(scratch / "index.db", video, clip->info(), models));
  const IndexJob job{.video = video, .threads = 1};
  const IndexPass pass{
      .job = job,
      .video = records.video,
      .searches = records.searches,
      .recognizer = recognizer,
      .extractor = *extractor,
      .kept_extractor = *extractor,
      .options = options,
      .intervals = schedule == Schedule::kDefault ? MakeSearchIntervals(options, clip->info()) : SearchIntervals(),
      .cameras = cameras,
      .sun = sun};
  IndexReport report;
  MeasureStages(true);
  VICTORIOUS_RETURN_IF_ERROR(RunIndexPass(pass, *clip, CancelToken(), *records.store, ignore, report));
  const std::array<double, kStageCount> stages_s = StageTimes();
  MeasureStages(false);

  const std::vector<double> times_ms = clip->FrameTimesMs();
  if (times_ms.empty()) return Fail(ErrorCode::kDataLoss, fmt::format("{}: no frame can be decoded", video));
  const auto count = static_cast<double>(times_ms.size());
  const double mean_ms = std::accumulate(times_ms.begin(), times_ms.end(), 0.0) / count;
  Result result{.name = fmt::format("index_{}_{}x{}", movie.name, models.size(), models.front().views.size()),
                .median_ms = Median(times_ms),
                .peer_median_ms = {{"opencv_sift", OpenCvSiftMs(clip->frames(), options.features)}},
                .figures = {{"mean_ms", mean_ms},
                            {"percentile99_ms", Percentile(times_ms, 99).value()},
                            {"slowest_ms", std::ranges::max(times_ms)},
                            {"searched_ms", MeanOfLongest(times_ms, report.frames_searched)}}};
  for (const auto& [stage, name] : kStageTexts) {
    if (stage == Stage::kSun) continue;
    const double stage_s = stages_s[static_cast<std::size_t>(stage)];
    result.figures.emplace_back(fmt::format("{}_ms", name), 1e3 * stage_s / count);
  }
  // Without decoding, tracks and the database.
  constexpr std::array kWholeFrame = {Stage::kFeatures,       Stage::kMatching,  Stage::kPoses,
                                      Stage::kRelitTemplates, Stage::kDetection, Stage::kNcc};
  double whole_s = 0;
  for (const Stage stage : kWholeFrame) whole_s += stages_s[static_cast<std::size_t>(stage)];
  const auto searched = static_cast<double>(std::max<std::int64_t>(1, report.frames_searched));
  result.figures.insert(result.figures.end(),
                        {{"frames_searched", searched}, {"whole_frame_ms", 1e3 * whole_s / searched}});
  const double start_all_s = std::accumulate(start_s.begin(), start_s.end(), 0.0);
  result.figures.insert(result.figures.end(), {{"start_s", start_all_s},
                                               {"frames", count},
                                               {"sightings", static_cast<double>(report.sightings)},
                                               {"sun_elevation_rad", sun ? sun->elevation_rad : 0.0}});
  return result;
}

}  // namespace

Expected<std::vector<Result>> BenchIndex(const Settings& settings) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<IndexMovie> movies, FindIndexMovies(settings));
  std::vector<Result> results;
  for (const std::size_t wanted : kModelCounts) {
    for (const IndexMovie& movie : movies) {
      std::vector<ObjectModel> models;
      for (const std::string& name : ListModels(movie.cad_files)) {
        if (models.size() == (settings.quick ? 1 : wanted)) break;
        VICTORIOUS_ASSIGN_OR_RETURN(models.emplace_back(), LoadIndexModel(movie.cad_files / (name + ".glb"), settings));
      }
      if (models.empty()) {
        return Fail(ErrorCode::kNotFound, fmt::format("{}: no CAD files NAME.glb", movie.cad_files.string()));
      }
      // Each once with templates that must be made for the sun, then with these.
      for (const auto& [schedule, frames, suffix] : {std::tuple(Schedule::kEachFrame, kFrames, ""),
                                                     std::tuple(Schedule::kDefault, kFramesByDefault, "_default")}) {
        const testing::ScratchFolder scratch;
        const RelitTemplateFolder folder(scratch.path(), "bench");
        for (const std::string_view run : {"", "_again"}) {
          VICTORIOUS_ASSIGN_OR_RETURN(results.emplace_back(),
                                      TimeIndex(movie, models, settings.quick ? 1 : frames, schedule, folder));
          results.back().name += fmt::format("{}{}", suffix, run);
        }
      }
    }
    if (settings.quick) break;
  }
  return results;
}

}  // namespace victorious::bench

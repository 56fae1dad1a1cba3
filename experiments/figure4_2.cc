// Figure 4.2: objects tracked by the tracker alone, and by tracker and recogniser together (experiments/steady_lock.h).
#include <algorithm>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "experiments/draw_matches.h"
#include "experiments/indexed_movie.h"
#include "experiments/steady_lock.h"
#include "experiments/system_experiments.h"
#include "experiments/video_frames.h"
#include "victorious/input/image/image_file.h"
#include "victorious/input/image/montage.h"

namespace victorious {
namespace {

constexpr double kLockedOverlap = 0.5;

// A clear truth row with the overlap that each method reaches.
struct LockRow {
  TrackingComparisonStep step;
  double alone = 0;  ///< IoU of the boxes; 0 if the object is lost
  double together = 0;
};

struct Lock {
  std::string model;
  std::vector<LockRow> rows;

  [[nodiscard]] double Mean(double LockRow::* overlap) const {
    double sum = 0;
    for (const LockRow& row : rows) sum += row.*overlap;
    return rows.empty() ? 0 : sum / static_cast<double>(rows.size());
  }
  [[nodiscard]] double LockedFraction(double LockRow::* overlap) const {
    const auto locked = [&](const LockRow& row) { return row.*overlap >= kLockedOverlap; };
    return rows.empty() ? 0
                        : static_cast<double>(std::ranges::count_if(rows, locked)) / static_cast<double>(rows.size());
  }
};

double Overlap(const std::optional<Polygon>& outline, const Box& truth, const cv::Size& size) {
  if (!outline) return 0;
  const Box frame = FrameBox(size.width, size.height);
  return IntersectionOverUnion(Intersection(BoundingBox(*outline), frame), truth);
}

Expected<Lock> TrackModel(const MovieWithTruth& movie, const ObjectModel& model, const ExperimentSettings& settings) {
  settings.progress(fmt::format("tracking the {} of {}", model.name, movie.name));
  const IndexOptions options = TrackingIndexOptions();
  VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, VideoReader::Open((movie.folder / "video.mp4").string(), {}));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto extractor, MakeFeatureExtractor(options.features));
  VICTORIOUS_ASSIGN_OR_RETURN(const Recognizer recognizer,
                              Recognizer::Create({model}, options.features.engine, options.recognize));
  VICTORIOUS_ASSIGN_OR_RETURN(
      const std::vector<TrackingComparisonStep> steps,
      CompareTracking(*reader, recognizer, *extractor, options.follow.track, settings.Cancel()));
  const cv::Size size(reader->info().width, reader->info().height);
  Lock lock{.model = model.name, .rows = {}};
  for (const TrackingComparisonStep& step : steps) {
    for (const TruthRow& row : movie.truth) {
      if (row.frame != step.frame || row.model != model.name || !IsClear(row)) continue;
      lock.rows.push_back({step, Overlap(step.alone, row.box, size), Overlap(step.together, row.box, size)});
      break;
    }
  }
  return lock;
}

// Four frames; tracker and recogniser above, the tracker alone below.
Expected<cv::Mat> Draw(const MovieWithTruth& movie, const Lock& lock) {
  constexpr int kMoments = 4;
  constexpr double kScale = 0.45;
  std::vector<std::int64_t> numbers;
  std::vector<const LockRow*> rows;
  for (const std::int64_t at : EvenlySpaced(static_cast<std::int64_t>(lock.rows.size()), kMoments)) {
    rows.push_back(&lock.rows[static_cast<std::size_t>(at)]);
    numbers.push_back(rows.back()->step.frame);
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<Frame> frames,
                              ReadNumberedFrames(movie.folder / "video.mp4", numbers, FrameColor::kGrey));
  std::vector<cv::Mat> images;
  for (const bool together : {true, false}) {
    for (std::size_t i = 0; i < frames.size(); ++i) {
      cv::Mat image = PosteriseImage(frames[i].image, kScale);
      const std::optional<Polygon>& outline = together ? rows[i]->step.together : rows[i]->step.alone;
      std::vector<cv::Point> corners;
      for (const Eigen::Vector2d& corner : outline.value_or(Polygon())) {
        corners.emplace_back(static_cast<int>(corner.x() * kScale), static_cast<int>(corner.y() * kScale));
      }
      const cv::Scalar colour = together ? cv::Scalar(60, 220, 60) : cv::Scalar(60, 60, 255);
      if (!corners.empty()) cv::polylines(image, corners, true, colour, 2);
      cv::putText(image, fmt::format("{:.1f} s", rows[i]->step.time_s), {4, image.rows - 6}, cv::FONT_HERSHEY_SIMPLEX,
                  0.4, cv::Scalar::all(255), 1);
      images.push_back(std::move(image));
    }
  }
  return Montage(images, static_cast<int>(frames.size()));
}

}  // namespace

Expected<Report> RunFigure42(const ExperimentSettings& settings) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<MovieWithTruth> movies, SimulateScenes({"circle"}, settings));
  const MovieWithTruth& movie = movies.front();
  Report report{.title = "A steady lock: the tracker alone, and with the recogniser",
                .columns = {"object", "frames", "alone: mean overlap", "alone: locked",
                            "alone: locked in the last quarter", "with recogniser: mean overlap",
                            "with recogniser: locked", "with recogniser: locked in the last quarter"}};
  std::map<std::int64_t, std::pair<std::vector<double>, std::vector<double>>> by_frame;
  std::optional<Lock> shown;
  for (const ObjectModel& model : movie.models) {
    VICTORIOUS_ASSIGN_OR_RETURN(const Lock lock, TrackModel(movie, model, settings));
    if (lock.rows.empty()) continue;
    const Lock end{
        .model = lock.model,
        .rows = {lock.rows.begin() + static_cast<std::ptrdiff_t>(lock.rows.size() * 3 / 4), lock.rows.end()}};
    std::vector<Cell> row = {model.name, static_cast<double>(lock.rows.size())};
    for (const auto overlap : {&LockRow::alone, &LockRow::together}) {
      row.emplace_back(lock.Mean(overlap));
      row.emplace_back(lock.LockedFraction(overlap));
      row.emplace_back(end.LockedFraction(overlap));
    }
    report.rows.push_back(std::move(row));
    for (const LockRow& one : lock.rows) {
      by_frame[one.step.frame].first.push_back(one.alone);
      by_frame[one.step.frame].second.push_back(one.together);
    }
    if (model.name == "jeep" || !shown) shown = lock;
  }
  if (!shown) return Fail(ErrorCode::kNotFound, fmt::format("{}: no object was detected to track", movie.name));
  VICTORIOUS_ASSIGN_OR_RETURN(const cv::Mat image, Draw(movie, *shown));
  VICTORIOUS_RETURN_IF_ERROR(WriteImage(settings.out / "figure4.2.png", image));

  PlotLine alone{.name = "tracker alone", .points = {}, .marked = false};
  PlotLine together{.name = "tracker and recogniser", .points = {}, .marked = false};
  for (const auto& [frame, overlaps] : by_frame) {
    alone.points.push_back({static_cast<double>(frame), ComputeMean(overlaps.first).mean});
    together.points.push_back({static_cast<double>(frame), ComputeMean(overlaps.second).mean});
  }
  report.plot = {.title = "Overlap with the truth, mean of the objects",
                 .x = {.label = "frame"},
                 .y = {.label = "overlap of boxes", .low = 0, .high = 1},
                 .lines = {alone, together}};
  report.notes = {
      fmt::format("Movie: {}. Each object from its first detection on, in the frames in which it is clear. Alone, the "
                  "tracker follows the points of the first detection; with the recogniser, each detection in the "
                  "tracked region becomes its new template. Overlap: IoU of the outline's box with the true box, 0 if "
                  "lost; locked: {:g} or more.",
                  DescribeMovies(movies), kLockedOverlap),
      fmt::format("The image: {}; with the recogniser above (green), alone below (red).", shown->model)};
  return report;
}

}  // namespace victorious

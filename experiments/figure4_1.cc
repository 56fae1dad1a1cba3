// Figure 4.1: the cost of recognition with and without a tracker. One frame is searched as a whole for every view of
// every model; the next one only in the tracked region, for the matched view and its neighbours.
#include <algorithm>
#include <array>
#include <ctime>
#include <functional>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "experiments/draw_matches.h"
#include "experiments/indexed_movie.h"
#include "experiments/system_experiments.h"
#include "experiments/video_frames.h"
#include "experiments/view_grid.h"
#include "victorious/input/image/image_file.h"
#include "victorious/input/image/montage.h"
#include "victorious/place/calibrate/sun_direction.h"
#include "victorious/search/follow/region_features.h"
#include "victorious/track/region_tracker.h"

namespace victorious {
namespace {

constexpr const char* kSoughtKind = "jeep";  // in place of the thesis's Humvee

// CPU time of all threads, median of 7 repetitions, ms.
double MedianCpuMs(const std::function<void()>& step) {
  constexpr std::size_t kRuns = 7;
  std::vector<double> ms(kRuns);
  for (double& time : ms) {
    const std::clock_t start = std::clock();
    step();
    time = 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  }
  return *Percentile(ms, 50);
}

// The extent and the cost of one search.
struct SearchCost {
  double pixels = 0;
  double keypoints = 0;
  double models = 0;
  double views = 0;
  double comparisons = 0;  ///< descriptor comparisons, scene with template
  double features_ms = 0;
  double recognition_ms = 0;
};

// The search of one frame.
struct SearchedBox {
  cv::Mat grey;
  FeatureSet features;
  std::vector<std::vector<double>> neg_log10_nfa;  ///< -log10 NFA of each model's views; 0 for views not searched
  std::vector<std::vector<std::size_t>> views;
  std::optional<Detection> found;  ///< of the tracked model
  Box box;                         ///< searched region
  SearchCost cost;
};

struct SearchSetup {
  const Recognizer& recognizer;  ///< with a minimum score of 0
  const FeatureExtractor& extractor;
  std::size_t model;  ///< index of the tracked model
};

// Recognises each view separately.
Status RecognizeEachView(const SearchSetup& setup, const FrameConditions& conditions, SearchedBox& searched) {
  for (std::size_t m = 0; m < searched.views.size(); ++m) {
    const ObjectModel& model = setup.recognizer.models()[m];
    std::vector<double>& neg_log10_nfa = searched.neg_log10_nfa.emplace_back(model.views.size(), 0);
    for (const std::size_t view : searched.views[m]) {
      VICTORIOUS_ASSIGN_OR_RETURN(
          const std::vector<Detection> found,
          setup.recognizer.RecognizeViews(searched.features, m, std::span(&view, 1), conditions));
      if (!found.empty()) neg_log10_nfa[view] = std::max(0.0, found.front().neg_log10_nfa);
      searched.cost.comparisons +=
          static_cast<double>(searched.features.size()) * static_cast<double>(model.views[view].feature_count);
    }
    searched.cost.views += static_cast<double>(searched.views[m].size());
    searched.cost.models += searched.views[m].empty() ? 0 : 1;
  }
  return {};
}

Expected<SearchedBox> SearchBox(const SearchSetup& setup, const Frame& frame, const Box& box,
                                std::vector<std::vector<std::size_t>> views, const FrameConditions& conditions) {
  SearchedBox searched{.grey = frame.image,
                       .features = {},
                       .neg_log10_nfa = {},
                       .views = std::move(views),
                       .found = {},
                       .box = box,
                       .cost = {}};
  VICTORIOUS_ASSIGN_OR_RETURN(searched.features, FeaturesIn(frame.image, box, setup.extractor));
  VICTORIOUS_RETURN_IF_ERROR(RecognizeEachView(setup, conditions, searched));
  const bool whole = searched.cost.models > 1;
  const auto recognize = [&] {
    return whole ? setup.recognizer.Recognize(searched.features, conditions)
                 : setup.recognizer.RecognizeViews(searched.features, setup.model, searched.views[setup.model],
                                                   conditions);
  };
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<Detection> detections, recognize());
  for (const Detection& detection : detections) {
    if (detection.model_index == setup.model && !searched.found) searched.found = detection;
  }
  SearchCost& cost = searched.cost;
  cost.pixels = box.Area();
  cost.keypoints = static_cast<double>(searched.features.size());
  cost.features_ms = MedianCpuMs([&] { static_cast<void>(FeaturesIn(frame.image, box, setup.extractor).has_value()); });
  cost.recognition_ms = MedianCpuMs([&] { static_cast<void>(recognize().has_value()); });
  return searched;
}

cv::Mat DrawFrame(const SearchedBox& searched, const cv::Scalar& colour) {
  constexpr double kScale = 0.62;
  cv::Mat image = PosteriseImage(searched.grey, kScale);
  const auto point = [&](double x, double y) {
    return cv::Point(static_cast<int>(x * kScale), static_cast<int>(y * kScale));
  };
  const Box& box = searched.box;
  cv::rectangle(image, point(box.x, box.y), point(box.x + box.width - 2, box.y + box.height - 2), colour, 2);
  if (searched.found) {
    std::vector<cv::Point> outline;
    for (const Eigen::Vector2d& corner : searched.found->outline) outline.push_back(point(corner.x(), corner.y()));
    cv::polylines(image, outline, true, cv::Scalar(60, 60, 255), 2);
  }
  return image;
}

// The frame, and below it the heat map of -log10 NFA over each model's views.
cv::Mat Column(const SearchedBox& searched, const std::vector<ObjectModel>& models, const cv::Scalar& colour) {
  std::vector<cv::Mat> images = {DrawFrame(searched, colour)};
  for (std::size_t m = 0; m < models.size(); ++m) {
    const double most = std::ranges::max(searched.neg_log10_nfa[m]);
    HighlightedViews highlighted{.views = {}, .colour = cv::Scalar(0, 255, 255)};
    if (searched.views[m].size() < models[m].views.size()) {
      for (const std::size_t view : searched.views[m]) highlighted.views.push_back(*models[m].views[view].angles);
    }
    const std::string caption = searched.views[m].empty() ? fmt::format("{}: not searched", models[m].name)
                                                          : fmt::format("{}: {} views, at most {:.0f}", models[m].name,
                                                                        searched.views[m].size(), most);
    images.push_back(DrawHeatMap(MakeViewGrid(models[m], searched.neg_log10_nfa[m]), caption, highlighted));
  }
  int width = 0;
  for (const cv::Mat& image : images) width = std::max(width, image.cols);
  for (cv::Mat& image : images) {
    cv::copyMakeBorder(image, image, 0, 4, 0, width - image.cols, cv::BORDER_CONSTANT, cv::Scalar::all(255));
  }
  cv::Mat column;
  cv::vconcat(images, column);
  return column;
}

// The middle frame of the clear rows of the model kSoughtKind, such that a later row exists.
Expected<std::int64_t> MiddleFrame(const MovieWithTruth& movie) {
  std::vector<std::int64_t> frames;
  for (const TruthRow& row : movie.truth) {
    if (row.model == kSoughtKind && IsClear(row)) frames.push_back(row.frame);
  }
  if (frames.size() < 2)
    return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: must show a {} in two frames", movie.name, kSoughtKind));
  return frames[(frames.size() - 1) / 2];
}

std::vector<Cell> MakeRow(const std::string& what, const SearchCost& cost) {
  return {what,
          cost.pixels,
          cost.keypoints,
          cost.models,
          cost.views,
          cost.comparisons,
          cost.features_ms,
          cost.recognition_ms,
          cost.features_ms + cost.recognition_ms};
}

}  // namespace

Expected<Report> RunFigure41(const ExperimentSettings& settings) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<MovieWithTruth> movies, SimulateScenes({"straight"}, settings));
  const MovieWithTruth& movie = movies.front();
  VICTORIOUS_ASSIGN_OR_RETURN(const CameraTrajectory cameras, ReadCameraTrack(movie));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t first, MiddleFrame(movie));
  const std::array<std::int64_t, 2> numbers = {first, first + 1};
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<Frame> frames,
                              ReadNumberedFrames(movie.folder / "video.mp4", numbers, FrameColor::kGrey));
  IndexOptions options = TrackingIndexOptions();
  options.recognize.detect.min_score = 0;  // the heat maps show all detections
  VICTORIOUS_ASSIGN_OR_RETURN(const auto extractor, MakeFeatureExtractor(options.features));
  VICTORIOUS_ASSIGN_OR_RETURN(const Recognizer recognizer,
                              Recognizer::Create(movie.models, options.features.engine, options.recognize));
  const auto model =
      static_cast<std::size_t>(std::ranges::find(movie.models, kSoughtKind, &ObjectModel::name) - movie.models.begin());
  const SearchSetup setup{recognizer, *extractor, model};
  const auto conditions = [&](const Frame& frame) {
    return MakeFrameConditions(cameras.At(frame.time_s), frame.image.size(), {});
  };

  std::vector<std::vector<std::size_t>> every_view;
  for (const ObjectModel& one : movie.models) {
    every_view.emplace_back(one.views.size());
    for (std::size_t view = 0; view < one.views.size(); ++view) every_view.back()[view] = view;
  }
  const Box whole = FrameBox(frames[0].image.cols, frames[0].image.rows);
  settings.progress("searching a whole frame, view by view");
  VICTORIOUS_ASSIGN_OR_RETURN(const SearchedBox before,
                              SearchBox(setup, frames[0], whole, every_view, conditions(frames[0])));
  if (!before.found) {
    return Fail(ErrorCode::kNotFound, fmt::format("{}, frame {}: no {} was detected", movie.name, first, kSoughtKind));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(RegionTracker tracker, RegionTracker::Create(options.follow.track));
  tracker.Step(frames[0]);
  tracker.Start(before.found->outline, MatchedPoints(*before.found, before.features));
  const std::vector<TrackStep> steps = tracker.Step(frames[1]);
  if (steps.empty() || !steps.front().seen()) {
    return Fail(ErrorCode::kNotFound,
                fmt::format("{}, frame {}: the {} was not tracked", movie.name, first, kSoughtKind));
  }
  const ModelView& matched = movie.models[model].views[before.found->view];
  std::vector<std::vector<std::size_t>> near_views(movie.models.size());
  near_views[model].assign(matched.neighbours.begin(), matched.neighbours.end());
  near_views[model].push_back(before.found->view);
  VICTORIOUS_ASSIGN_OR_RETURN(const SearchedBox after,
                              SearchBox(setup, frames[1], steps.front().search_box, near_views, conditions(frames[1])));

  cv::Mat image;
  const cv::Mat left = Column(before, movie.models, cv::Scalar(255, 120, 40));
  cv::Mat gap(left.rows, 6, CV_8UC3, cv::Scalar::all(255));
  cv::hconcat(std::vector<cv::Mat>{left, gap, Column(after, movie.models, cv::Scalar(0, 255, 255))}, image);
  VICTORIOUS_RETURN_IF_ERROR(WriteImage(settings.out / "figure4.1.png", image));

  Report report{.title = "Search of a whole frame, and of the tracked region in the next",
                .columns = {"search", "pixels", "keypoints", "models", "views", "descriptors compared", "features, ms",
                            "recognition, ms", "total, ms"},
                .rows = {MakeRow("whole frame", before.cost), MakeRow("tracked region", after.cost)}};
  std::vector<Cell> ratio = {"reduction factor"};
  for (std::size_t i = 1; i < report.columns.size(); ++i) {
    ratio.emplace_back(std::get<double>(report.rows[0][i]) / std::max(1e-3, std::get<double>(report.rows[1][i])));
  }
  report.rows.push_back(std::move(ratio));
  report.rows.push_back({"thesis, reduction factor", 640.0 * 480 / (120 * 60), "", 4.0, 4 * 253.0 / 9, "", "", "",
                         "some 1000, predicted"});
  const TruthRow* truth = nullptr;
  for (const TruthRow& row : movie.truth) {
    if (row.frame == numbers[1] && row.model == kSoughtKind) truth = &row;
  }
  report.notes = {
      fmt::format("Frames {} and {} of {}, the {}; CPU time of all threads, medians of 7 repetitions. The tracker "
                  "itself, about 2 ms per frame, is not included.",
                  numbers[0], numbers[1], movie.name, kSoughtKind),
      fmt::format("In the tracked region it is {}{}.", after.found ? "found" : "not found",
                  after.found && truth != nullptr ? fmt::format(", its box overlapping the true one by {:.2f}",
                                                                IntersectionOverUnion(after.found->box, truth->box))
                                                  : ""),
      "The image: left the whole frame (blue) and -log10 NFA of each model's 253 views, azimuth to the right, "
      "off-nadir angle downwards; right the next frame with the tracked region (yellow) and the views searched there; "
      "detections in red."};
  return report;
}

}  // namespace victorious

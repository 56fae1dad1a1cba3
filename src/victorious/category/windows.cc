#include "victorious/category/windows.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <opencv2/imgproc.hpp>

#include "victorious/base/check.h"

namespace victorious {
namespace {

constexpr float kPatchHalfSide = 6;  // half side of a patch in units of the keypoint's scale: two cells of three sigma

// A contiguous range of features of one scale in one row of the grid.
struct Row {
  float y = 0;
  float reach = 0;  // half side of their patches, px
  std::size_t first = 0;
  std::size_t end = 0;
};

// The image resampled for one window size, so that a window has `side_px` pixels per side, with its features.
struct WindowLevel {
  double side = 0;  // side of its windows, px of the image before resampling
  cv::Size size;
  FeatureSet features;
  QuantisedImage image;  // quantised features, without a Fisher vector
  std::vector<Row> rows;
};

// Relies on the order of DenseFeatures: by scale, then by row.
std::vector<Row> FindRows(const std::vector<Keypoint>& keypoints) {
  std::vector<Row> rows;
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    const float reach = kPatchHalfSide * keypoints[i].scale_px;
    if (rows.empty() || rows.back().y != keypoints[i].y || rows.back().reach != reach)
      rows.push_back({.y = keypoints[i].y, .reach = reach, .first = i, .end = i});
    rows.back().end = i + 1;
  }
  return rows;
}

cv::Size LevelSize(const cv::Size& image, double side, int side_px) {
  const double scale = side_px / side;
  return {std::max(side_px, cvRound(image.width * scale)), std::max(side_px, cvRound(image.height * scale))};
}

double DownscaleFactor(const cv::Size& image, const WindowOptions& options) {
  return std::min(1.0, static_cast<double>(options.max_side_px) / std::max(image.width, image.height));
}

WindowLevel MakeLevel(const CategoryModel& model, const cv::Mat& grey, double side, const DenseOptions& dense,
                      const WindowOptions& options) {
  WindowLevel level{
      .side = side, .size = LevelSize(grey.size(), side, options.side_px), .features = {}, .image = {}, .rows = {}};
  cv::Mat resampled;
  cv::resize(grey, resampled, level.size, 0, 0, side > options.side_px ? cv::INTER_AREA : cv::INTER_LINEAR);
  DenseOptions at_this_size = dense;
  at_this_size.max_side_px = std::max(level.size.width, level.size.height);
  level.features = DenseFeatures(resampled, at_this_size);
  level.image = QuantiseFeatures(level.features, model.vocabulary, model.options.vocabulary.words_per_keypoint);
  level.rows = FindRows(level.features.keypoints);
  return level;
}

struct WindowCandidate {
  std::size_t level = 0;
  cv::Point corner;  // top left, px of the level
  double score = 0;  // log odds by words and shapes
};

std::vector<int> WindowOffsets(int length, int side, int step) {
  std::vector<int> steps;
  for (int at = 0; at + side < length; at += step) steps.push_back(at);
  steps.push_back(length - side);
  return steps;
}

// Indices of the features whose patches lie entirely in the window.
std::vector<std::size_t> FindFeaturesInside(const WindowLevel& level, const cv::Point& corner, int side_px) {
  constexpr float kRounding = 0.01F;
  std::vector<std::size_t> inside;
  for (const Row& row : level.rows) {
    const float low = row.reach - kRounding;
    const float high = static_cast<float>(side_px) - low;
    const float y = row.y - static_cast<float>(corner.y);
    if (y < low || y > high) continue;
    const auto x_of = [&](std::size_t i) { return level.features.keypoints[i].x - static_cast<float>(corner.x); };
    std::size_t i = row.first;
    while (i < row.end && x_of(i) < low) ++i;
    for (; i < row.end && x_of(i) <= high; ++i) inside.push_back(i);
  }
  return inside;
}

// The features of a window, with positions relative to its corner.
FeatureSet CropFeatures(const WindowLevel& level, std::span<const std::size_t> features, const cv::Point& corner,
                        int side_px) {
  FeatureSet part{.keypoints = {}, .descriptors = {}, .image_width = side_px, .image_height = side_px};
  part.keypoints.reserve(features.size());
  part.descriptors.reserve(features.size() * kDescriptorSize);
  for (const std::size_t i : features) {
    Keypoint keypoint = level.features.keypoints[i];
    keypoint.x -= static_cast<float>(corner.x);
    keypoint.y -= static_cast<float>(corner.y);
    part.keypoints.push_back(keypoint);
    const auto descriptor = level.features.View().Descriptor(i);
    part.descriptors.insert(part.descriptors.end(), descriptor.begin(), descriptor.end());
  }
  return part;
}

// The quantised features of a window: words copied from the level, and the shape of the crop.
QuantisedImage QuantiseFeatures(const CategoryModel& model, const WindowLevel& level,
                                std::span<const std::size_t> features, const FeatureSet& crop) {
  QuantisedImage part;
  part.keypoints = crop.keypoints;
  part.words_per_keypoint = level.image.words_per_keypoint;
  part.width = crop.image_width;
  part.height = crop.image_height;
  part.assignments.reserve(features.size() * part.words_per_keypoint);
  for (const std::size_t i : features) {
    const auto assignments = level.image.Assignments(i);
    part.assignments.insert(part.assignments.end(), assignments.begin(), assignments.end());
  }
  part.shape = model.linear()->shape.Encode(crop);
  return part;
}

// Maximum log odds over the wanted nodes. Log odds, because probabilities near 1 lose resolution.
double MaxLogOdds(const CategoryModel& model, const CategoryResult& result, CategoryMethod method,
                  std::span<const std::size_t> wanted) {
  double best = -std::numeric_limits<double>::infinity();
  for (const std::size_t node : wanted)
    best = std::max(best, model.nodes[node].CalibrationFor(method).LogOdds(result.scores[node].raw));
  return best;
}

ScoredWindow ScoreWindow(const CategoryModel& model, const WindowLevel& level, const cv::Point& corner, int side_px) {
  const std::vector<std::size_t> inside = FindFeaturesInside(level, corner, side_px);
  const FeatureSet crop = CropFeatures(level, inside, corner, side_px);
  ScoredWindow window{.box = {}, .result = {}, .image = QuantiseFeatures(model, level, inside, crop)};
  window.image.fisher = model.linear()->fisher.Encode(crop);
  window.result = Classify(model, window.image, CategoryMethod::kPhrases);
  const double scale = level.side / side_px;
  window.box = {corner.x * scale, corner.y * scale, level.side, level.side};
  return window;
}

}  // namespace

void WindowOptions::ListFields(FieldList& fields) {
  fields.Add("enabled", enabled,
             {.reason = "true: sliding windows of many sizes, for objects that are small in the image or occur "
                        "several times; false: an image is classified as a whole"});
  fields.Add("side_px", side_px,
             {.min = 32, .max = 512, .unit = "px", .reason = "side to which a window is resampled for the features"});
  fields.Add("min_window_px", min_window_px,
             {.min = 16, .max = 4096, .unit = "px", .reason = "side of the smallest windows"});
  fields.Add("max_side_px", max_side_px,
             {.min = 64, .max = 16384, .unit = "px", .reason = "images with a longer side are downscaled to it"});
}

std::vector<double> WindowSides(const cv::Size& image, const WindowOptions& options) {
  const double shorter_side = std::min(image.width, image.height);
  std::vector<double> sides;
  for (double side = options.min_window_px; side * std::sqrt(kWindowSizeFactor) < shorter_side;
       side *= kWindowSizeFactor)
    sides.push_back(side);
  sides.push_back(shorter_side);
  return sides;
}

std::size_t WindowCount(const cv::Size& image, int grid_step_px, const WindowOptions& options) {
  const int step_px = kWindowStepGridPoints * grid_step_px;
  const double shrink = DownscaleFactor(image, options);
  const cv::Size size(cvRound(image.width * shrink), cvRound(image.height * shrink));
  std::size_t count = 0;
  for (const double side : WindowSides(size, options)) {
    const cv::Size level = LevelSize(size, side, options.side_px);
    count += WindowOffsets(level.width, options.side_px, step_px).size() *
             WindowOffsets(level.height, options.side_px, step_px).size();
  }
  return count;
}

std::vector<ScoredWindow> ClassifyWindows(const CategoryModel& model, const cv::Mat& grey, const DenseOptions& dense,
                                          const WindowOptions& options, std::span<const std::size_t> wanted) {
  VICTORIOUS_CHECK(grey.type() == CV_8UC1 && model.linear() != nullptr);
  const int step_px = kWindowStepGridPoints * dense.step_px;
  const double shrink = DownscaleFactor(grey.size(), options);
  cv::Mat image = grey;
  if (shrink < 1) cv::resize(grey, image, {}, shrink, shrink, cv::INTER_AREA);
  std::vector<WindowLevel> levels;
  std::vector<WindowCandidate> candidates;
  for (const double side : WindowSides(image.size(), options)) {
    const WindowLevel& level = levels.emplace_back(MakeLevel(model, image, side, dense, options));
    for (const int y : WindowOffsets(level.size.height, options.side_px, step_px)) {
      for (const int x : WindowOffsets(level.size.width, options.side_px, step_px)) {
        const std::vector<std::size_t> inside = FindFeaturesInside(level, {x, y}, options.side_px);
        if (inside.empty()) continue;
        const FeatureSet crop = CropFeatures(level, inside, {x, y}, options.side_px);
        const CategoryResult by_words =
            Classify(model, QuantiseFeatures(model, level, inside, crop), CategoryMethod::kWords);
        candidates.push_back({levels.size() - 1, {x, y}, MaxLogOdds(model, by_words, CategoryMethod::kWords, wanted)});
      }
    }
  }
  std::ranges::stable_sort(candidates, std::ranges::greater(), &WindowCandidate::score);
  candidates.resize(std::min(candidates.size(), std::size_t{kMaxRescoredWindows}));
  // Correction for multiple testing: the odds are divided by the ratio of the number of windows to that in calibration.
  const double calibration_count = model.windows ? model.windows->windows_per_background : 0;
  const auto count = static_cast<double>(WindowCount(grey.size(), dense.step_px, options));
  const double odds_divisor = calibration_count > 0 ? std::max(1.0, count / calibration_count) : 1.0;
  std::vector<ScoredWindow> windows;
  for (const WindowCandidate& candidate : candidates) {
    ScoredWindow& window =
        windows.emplace_back(ScoreWindow(model, levels[candidate.level], candidate.corner, options.side_px));
    window.box = {window.box.x / shrink, window.box.y / shrink, window.box.width / shrink, window.box.height / shrink};
    for (const std::size_t node : wanted) {
      double& probability = window.result.scores[node].probability;
      probability /= probability + odds_divisor * (1 - probability);
    }
    for (std::size_t node = 0; node < model.nodes.size(); ++node) {  // the most probable label may have changed
      const std::vector<CategoryScore>& scores = window.result.scores;
      if (model.nodes[node].can_be_label && scores[node].probability > scores[window.result.label].probability)
        window.result.label = node;
    }
  }
  std::ranges::stable_sort(windows, std::ranges::greater(), [&](const ScoredWindow& window) {
    return MaxLogOdds(model, window.result, CategoryMethod::kPhrases, wanted);
  });
  return windows;
}

bool IsSameObject(const Box& a, const Box& b) {
  // A small window in a large one shows a part of the same object, or the object without its surroundings.
  constexpr double kMostlyInside = 0.6;
  return IntersectionOverUnion(a, b) > kMaxWindowOverlap ||
         Intersection(a, b).Area() > kMostlyInside * std::min(a.Area(), b.Area());
}

}  // namespace victorious

#include "victorious/category/windows.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <opencv2/imgproc.hpp>

#include "victorious/base/check.h"

namespace victorious {
namespace {

constexpr float kReach = 6;  // half side of a patch in units of the keypoint's scale: two cells of three sigma

// A contiguous range of features of one scale in one row of the grid.
struct Row {
  float y = 0;
  float reach = 0;  // half side of their patches, px
  std::size_t first = 0;
  std::size_t end = 0;
};

// The image resampled for one window size, so that a window has `side_px` pixels per side, with its features.
struct Level {
  double side = 0;  // side of its windows, px of the image before resampling
  cv::Size size;
  FeatureSet features;
  WordedPicture picture;  // quantised features, without a Fisher vector
  std::vector<Row> rows;
};

// Relies on the order of DenseFeatures: by scale, then by row.
std::vector<Row> RowsOf(const std::vector<Keypoint>& keypoints) {
  std::vector<Row> rows;
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    const float reach = kReach * keypoints[i].scale_px;
    if (rows.empty() || rows.back().y != keypoints[i].y || rows.back().reach != reach)
      rows.push_back({.y = keypoints[i].y, .reach = reach, .first = i, .end = i});
    rows.back().end = i + 1;
  }
  return rows;
}

cv::Size SizeOfLevel(const cv::Size& picture, double side, int side_px) {
  const double scale = side_px / side;
  return {std::max(side_px, cvRound(picture.width * scale)), std::max(side_px, cvRound(picture.height * scale))};
}

double ShrinkOf(const cv::Size& picture, const WindowOptions& options) {
  return std::min(1.0, static_cast<double>(options.max_side_px) / std::max(picture.width, picture.height));
}

Level MakeLevel(const CategoryModel& model, const cv::Mat& grey, double side, const DenseOptions& dense,
                const WindowOptions& options) {
  Level level{
      .side = side, .size = SizeOfLevel(grey.size(), side, options.side_px), .features = {}, .picture = {}, .rows = {}};
  cv::Mat resampled;
  cv::resize(grey, resampled, level.size, 0, 0, side > options.side_px ? cv::INTER_AREA : cv::INTER_LINEAR);
  DenseOptions at_this_size = dense;
  at_this_size.max_side_px = std::max(level.size.width, level.size.height);
  level.features = DenseFeatures(resampled, at_this_size);
  level.picture = WordsOf(level.features, model.vocabulary, model.options.soft_words, model.options.softness);
  level.rows = RowsOf(level.features.keypoints);
  return level;
}

struct Place {
  std::size_t level = 0;
  cv::Point corner;  // top left, px of the level
  double score = 0;  // log odds by words and shapes
};

std::vector<int> Steps(int length, int side, int step) {
  std::vector<int> steps;
  for (int at = 0; at + side < length; at += step) steps.push_back(at);
  steps.push_back(length - side);
  return steps;
}

// Indices of the features whose patches lie entirely in the window.
std::vector<std::size_t> FeaturesIn(const Level& level, const cv::Point& corner, int side_px) {
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
FeatureSet CutOut(const Level& level, std::span<const std::size_t> features, const cv::Point& corner, int side_px) {
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
WordedPicture WordsOf(const CategoryModel& model, const Level& level, std::span<const std::size_t> features,
                      const FeatureSet& cut_out) {
  WordedPicture part;
  part.keypoints = cut_out.keypoints;
  part.few = level.picture.few;
  part.width = cut_out.image_width;
  part.height = cut_out.image_height;
  part.shares.reserve(features.size() * part.few);
  for (const std::size_t i : features) {
    const auto shares = level.picture.Shares(i);
    part.shares.insert(part.shares.end(), shares.begin(), shares.end());
  }
  part.shape = model.shape.Encode(cut_out);
  return part;
}

// Maximum log odds over the wanted nodes. Log odds, because probabilities near 1 lose resolution.
double Likeliest(const CategoryModel& model, const CategoryResult& result, CategoryMethod method,
                 std::span<const std::size_t> wanted) {
  double best = -std::numeric_limits<double>::infinity();
  for (const std::size_t node : wanted) {
    const Calibration& calibration =
        method == CategoryMethod::kPhrases ? model.nodes[node].phrases : model.nodes[node].words;
    best = std::max(best, calibration.slope * result.scores[node].raw + calibration.offset);
  }
  return best;
}

SeenWindow Examine(const CategoryModel& model, const Level& level, const cv::Point& corner, int side_px) {
  const std::vector<std::size_t> inside = FeaturesIn(level, corner, side_px);
  const FeatureSet cut_out = CutOut(level, inside, corner, side_px);
  SeenWindow window{.box = {}, .result = {}, .picture = WordsOf(model, level, inside, cut_out)};
  window.picture.fisher = model.fisher.Encode(cut_out);
  window.result = Classify(model, window.picture, CategoryMethod::kPhrases);
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
  fields.Add("smallest_px", smallest_px,
             {.min = 16, .max = 4096, .unit = "px", .reason = "side of the smallest windows"});
  fields.Add("size_factor", size_factor, {.min = 1.05, .max = 4, .reason = "ratio of successive window sizes"});
  fields.Add("step_px", step_px,
             {.min = 2,
              .max = 512,
              .unit = "px",
              .reason = "step between windows, after resampling; use a multiple of dense.step_px"});
  fields.Add("room", room,
             {.min = 1, .max = 4, .reason = "side of a window relative to the longer side of the object's box"});
  fields.Add(
      "examined", examined,
      {.min = 1,
       .max = 100000,
       .reason = "windows per image that are rescored with phrases and Fisher vectors: the best by words and shapes"});
  fields.Add("overlap", overlap,
             {.min = 0,
              .max = 1,
              .reason = "non-maximum suppression: of windows with a greater intersection over union only the most "
                        "probable is kept"});
  fields.Add("max_side_px", max_side_px,
             {.min = 64, .max = 16384, .unit = "px", .reason = "images with a longer side are downscaled to it"});
  fields.Add("none", none,
             {.reason = "background category, of windows without an object; set by training to the category of the "
                        "images without boxes"});
  fields.Add("usual_windows", usual_windows,
             {.min = 0,
              .max = 1e9,
              .reason = "mean number of windows per image in calibration; set by training from the images without "
                        "boxes. For images with more windows, the odds of each window are reduced in proportion; 0: no "
                        "correction"});
}

std::vector<double> WindowSides(const cv::Size& picture, const WindowOptions& options) {
  const double longest = std::min(picture.width, picture.height);
  std::vector<double> sides;
  for (double side = options.smallest_px; side * std::sqrt(options.size_factor) < longest; side *= options.size_factor)
    sides.push_back(side);
  sides.push_back(longest);
  return sides;
}

std::size_t WindowCount(const cv::Size& picture, const WindowOptions& options) {
  const double shrink = ShrinkOf(picture, options);
  const cv::Size size(cvRound(picture.width * shrink), cvRound(picture.height * shrink));
  std::size_t count = 0;
  for (const double side : WindowSides(size, options)) {
    const cv::Size level = SizeOfLevel(size, side, options.side_px);
    count += Steps(level.width, options.side_px, options.step_px).size() *
             Steps(level.height, options.side_px, options.step_px).size();
  }
  return count;
}

std::vector<SeenWindow> LookThroughWindows(const CategoryModel& model, const cv::Mat& grey, const DenseOptions& dense,
                                           const WindowOptions& options, std::span<const std::size_t> wanted) {
  VICTORIOUS_CHECK(grey.type() == CV_8UC1 && model.options.scoring == "linear");
  const double shrink = ShrinkOf(grey.size(), options);
  cv::Mat picture = grey;
  if (shrink < 1) cv::resize(grey, picture, {}, shrink, shrink, cv::INTER_AREA);
  std::vector<Level> levels;
  std::vector<Place> places;
  for (const double side : WindowSides(picture.size(), options)) {
    const Level& level = levels.emplace_back(MakeLevel(model, picture, side, dense, options));
    for (const int y : Steps(level.size.height, options.side_px, options.step_px)) {
      for (const int x : Steps(level.size.width, options.side_px, options.step_px)) {
        const std::vector<std::size_t> inside = FeaturesIn(level, {x, y}, options.side_px);
        if (inside.empty()) continue;
        const FeatureSet cut_out = CutOut(level, inside, {x, y}, options.side_px);
        const CategoryResult by_words = Classify(model, WordsOf(model, level, inside, cut_out), CategoryMethod::kWords);
        places.push_back({levels.size() - 1, {x, y}, Likeliest(model, by_words, CategoryMethod::kWords, wanted)});
      }
    }
  }
  std::ranges::stable_sort(places, std::ranges::greater(), &Place::score);
  places.resize(std::min(places.size(), static_cast<std::size_t>(options.examined)));
  // Correction for multiple testing: the odds are divided by the ratio of the number of windows to that in calibration.
  const double usual = options.usual_windows;
  const double more_looks =
      usual > 0 ? std::max(1.0, static_cast<double>(WindowCount(grey.size(), options)) / usual) : 1.0;
  std::vector<SeenWindow> windows;
  for (const Place& place : places) {
    SeenWindow& window = windows.emplace_back(Examine(model, levels[place.level], place.corner, options.side_px));
    window.box = {window.box.x / shrink, window.box.y / shrink, window.box.width / shrink, window.box.height / shrink};
    for (const std::size_t node : wanted) {
      double& probability = window.result.scores[node].probability;
      probability /= probability + more_looks * (1 - probability);
    }
    for (std::size_t node = 0; node < model.nodes.size(); ++node) {  // the most probable label may have changed
      const std::vector<CategoryScore>& scores = window.result.scores;
      if (model.nodes[node].labels && scores[node].probability > scores[window.result.label].probability)
        window.result.label = node;
    }
  }
  std::ranges::stable_sort(windows, std::ranges::greater(), [&](const SeenWindow& window) {
    return Likeliest(model, window.result, CategoryMethod::kPhrases, wanted);
  });
  return windows;
}

bool ShowTheSame(const Box& a, const Box& b, double overlap) {
  // A small window in a large one shows a part of the same object, or the object without its surroundings.
  constexpr double kMostlyInside = 0.6;
  return IntersectionOverUnion(a, b) > overlap ||
         Intersection(a, b).Area() > kMostlyInside * std::min(a.Area(), b.Area());
}

}  // namespace victorious

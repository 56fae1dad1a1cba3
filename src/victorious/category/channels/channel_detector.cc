#include "victorious/category/channels/channel_detector.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <oneapi/tbb/parallel_for.h>

#include "victorious/kernels/window_trees.h"

namespace victorious {
namespace {

constexpr double kMinScanCell_px = 0.5;     // images are enlarged four times at most
constexpr double kMaxOverlap = 0.4;         // of boxes that both stay
constexpr double kMaxContained = 0.7;       // of the smaller of two boxes that both stay, in the other
constexpr double kVoteOverlap = 0.6;        // of boxes that move the best of them
constexpr std::size_t kMaxHitsARow = 4096;  // more are those of a model that rejects nothing
constexpr std::size_t kMaxBoxes = 8192;     // of a category, the best; likewise
constexpr double kHalfTurn = std::numbers::pi;

// The trees of a heading, with offsets into a level.
struct PlacedTrees {
  std::vector<kernels::WindowTree> trees;
  const std::vector<std::int16_t>* floors = nullptr;
};

PlacedTrees PlaceTrees(const ChannelLevel& level, const BoostedTrees& trained, const HeadingCopy& copy) {
  PlacedTrees placed{.trees = {}, .floors = &trained.floors};
  for (const FeatureTree& tree : trained.trees) {
    kernels::WindowTree at{.threshold = tree.threshold, .leaf = tree.leaf};
    for (std::size_t n = 0; n < tree.feature.size(); ++n) {
      const int seen = CopiedFeature(copy, tree.feature[n]);
      at.offset[n] = static_cast<std::int32_t>(level.planes.OffsetOf(
          seen / (kWindowCells * kWindowCells), seen % kWindowCells, seen / kWindowCells % kWindowCells));
    }
    placed.trees.push_back(at);
  }
  return placed;
}

// The next window from x on that is not rejected; `end` if there is none.
std::size_t FirstAccepted(const std::vector<std::int16_t>& scores, std::size_t x, std::size_t end) {
  constexpr std::size_t kAtOnce = 16;
  while (x + kAtOnce <= end) {
    bool is_any = false;
    for (std::size_t i = 0; i < kAtOnce; ++i) is_any |= scores[x + i] != kernels::kRejectedWindow;
    if (is_any) break;
    x += kAtOnce;
  }
  while (x < end && scores[x] == kernels::kRejectedWindow) ++x;
  return x;
}

HeadingCopy CopyOf(const ChannelCategory& category, int heading) {
  return category.turns ? kHeadingCopies[static_cast<std::size_t>(heading)] : HeadingCopy{};
}

// The part of the smaller box that lies in the other.
double Contained(const Box& a, const Box& b) { return Intersection(a, b).Area() / std::min(a.Area(), b.Area()); }

// Of boxes of one category.
std::vector<ChannelBox> Suppress(std::vector<ChannelBox> boxes) {
  std::ranges::stable_sort(boxes, std::greater{}, &ChannelBox::score);
  if (boxes.size() > kMaxBoxes) boxes.resize(kMaxBoxes);
  std::vector<ChannelBox> kept;
  std::vector<bool> is_suppressed(boxes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (is_suppressed[i]) continue;
    double weights = 0;
    Box sum;
    for (std::size_t j = i; j < boxes.size(); ++j) {
      if (is_suppressed[j]) continue;
      const double overlap = IntersectionOverUnion(boxes[i].box, boxes[j].box);
      // The box of another heading of the same object may lie in its box without overlapping much of it.
      if (overlap <= kMaxOverlap && Contained(boxes[i].box, boxes[j].box) <= kMaxContained) continue;
      is_suppressed[j] = true;
      if (overlap < kVoteOverlap) continue;
      const double weight = std::exp(boxes[j].score - boxes[i].score);
      weights += weight;
      sum.x += weight * boxes[j].box.x;
      sum.y += weight * boxes[j].box.y;
      sum.width += weight * boxes[j].box.width;
      sum.height += weight * boxes[j].box.height;
    }
    kept.push_back(boxes[i]);
    kept.back().box = {sum.x / weights, sum.y / weights, sum.width / weights, sum.height / weights};
  }
  return kept;
}

}  // namespace

double MinCellOf(const ChannelModel& model) {
  double longest = 1;
  for (const ChannelCategory& category : model.categories) {
    longest = std::max({longest, category.length, category.width});
  }
  return std::max(kMinScanCell_px, model.min_object_px / (kObjectCells * longest));
}

int HeadingsOf(const ChannelCategory& category) { return category.turns ? kHeadings : 1; }

std::vector<ChannelHit> ScanLevel(const ChannelLevel& level, const ChannelCategory& category) {
  std::vector<PlacedTrees> headings;
  for (int h = 0; h < HeadingsOf(category); ++h) {
    const HeadingCopy copy = CopyOf(category, h);
    headings.push_back(PlaceTrees(level, category.detectors[static_cast<std::size_t>(copy.trained)], copy));
  }
  const auto columns = static_cast<std::size_t>(level.WindowColumns());
  std::vector<std::vector<ChannelHit>> of_row(static_cast<std::size_t>(level.WindowRows()));
  constexpr std::size_t kRowsAtATime = 8;
  oneapi::tbb::parallel_for(std::size_t{0}, (of_row.size() + kRowsAtATime - 1) / kRowsAtATime, [&](std::size_t part) {
    std::vector<std::int16_t> scores(columns + kernels::kWindowPadding);
    const std::size_t end = std::min(of_row.size(), (part + 1) * kRowsAtATime);
    for (std::size_t y = part * kRowsAtATime; y < end; ++y) {
      for (int h = 0; h < std::ssize(headings); ++h) {
        const PlacedTrees& placed = headings[static_cast<std::size_t>(h)];
        if (placed.trees.empty()) continue;
        kernels::ScoreWindows(level.planes.bytes.data() + level.planes.OffsetOf(0, 0, static_cast<int>(y)), columns,
                              placed.trees, *placed.floors, scores.data());
        for (std::size_t x = 0; x < columns; ++x) {
          x = FirstAccepted(scores, x, columns);
          if (x == columns || of_row[y].size() >= kMaxHitsARow) break;
          of_row[y].push_back({.heading = h, .x = static_cast<int>(x), .y = static_cast<int>(y), .score = scores[x]});
        }
      }
    }
  });
  std::vector<ChannelHit> hits;
  for (const auto& some : of_row) hits.insert(hits.end(), some.begin(), some.end());
  return hits;
}

Box BoxOfHit(const ChannelLevel& level, const ChannelCategory& category, const ChannelHit& hit) {
  const cv::Size2d size = category.turns
                              ? BoxOfHeading(category.length, category.width, hit.heading * kHalfTurn / kHeadings)
                              : cv::Size2d(category.length, category.width);
  const cv::Point2d middle = level.Middle(hit.x, hit.y);
  const double width = size.width * kObjectCells * level.cell_width_px;
  const double height = size.height * kObjectCells * level.cell_height_px;
  return {middle.x - width / 2, middle.y - height / 2, width, height};
}

std::vector<ChannelBox> DetectByChannels(const ChannelModel& model, const cv::Mat& image, double min_probability) {
  std::vector<std::vector<ChannelBox>> of_category(model.categories.size());
  ForEachLevel(image, MinCellOf(model), [&](const ChannelLevel& level) {
    for (std::size_t c = 0; c < model.categories.size(); ++c) {
      const ChannelCategory& category = model.categories[c];
      for (const ChannelHit& hit : ScanLevel(level, category)) {
        const double score = hit.score / kLeafScale;
        const double probability = category.calibration.Probability(score);
        if (probability < min_probability) continue;
        of_category[c].push_back(
            {.category = c, .box = BoxOfHit(level, category, hit), .score = score, .probability = probability});
      }
    }
  });
  std::vector<ChannelBox> found;
  for (auto& boxes : of_category) {
    for (ChannelBox& one : Suppress(std::move(boxes))) {
      one.box = Intersection(one.box, FrameBox(image.cols, image.rows));
      if (!one.box.IsEmpty()) found.push_back(one);
    }
  }
  std::ranges::stable_sort(found, std::greater{}, &ChannelBox::probability);
  return found;
}

}  // namespace victorious

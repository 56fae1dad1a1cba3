#include "victorious/search/follow/category_follower.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "victorious/base/median.h"

namespace victorious {
namespace {

constexpr int kPointsPerSide = 5;
constexpr std::size_t kPoints = kPointsPerSide * kPointsPerSide;
constexpr std::size_t kMinTracked = 6;
constexpr double kInnerFraction = 0.8;  // of a box's sides: its border is background
constexpr double kMaxGrowth = 1.25;     // a frame

// The points of a grid in a box.
void AddPoints(const Box& box, std::vector<Eigen::Vector2d>& points) {
  for (int y = 0; y < kPointsPerSide; ++y) {
    for (int x = 0; x < kPointsPerSide; ++x) {
      const auto part = [](int i) { return 0.5 + kInnerFraction * ((i + 0.5) / kPointsPerSide - 0.5); };
      points.emplace_back(box.x + part(x) * box.width, box.y + part(y) * box.height);
    }
  }
}

std::optional<Box> MoveBox(const Box& box, std::span<const Eigen::Vector2d> from,
                           std::span<const std::optional<Eigen::Vector2d>> to) {
  std::vector<double> dx;
  std::vector<double> dy;
  std::vector<std::size_t> tracked;
  for (std::size_t i = 0; i < from.size(); ++i) {
    if (!to[i]) continue;
    tracked.push_back(i);
    dx.push_back(to[i]->x() - from[i].x());
    dy.push_back(to[i]->y() - from[i].y());
  }
  if (tracked.size() < kMinTracked) return std::nullopt;
  std::vector<double> ratios;
  for (std::size_t a = 0; a < tracked.size(); ++a) {
    for (std::size_t b = a + 1; b < tracked.size(); ++b) {
      const double before = (from[tracked[a]] - from[tracked[b]]).norm();
      if (before > 0) ratios.push_back((*to[tracked[a]] - *to[tracked[b]]).norm() / before);
    }
  }
  const double growth = std::clamp(Median(ratios), 1 / kMaxGrowth, kMaxGrowth);
  const double x = box.x + box.width / 2 + Median(dx);
  const double y = box.y + box.height / 2 + Median(dy);
  return Box{x - growth * box.width / 2, y - growth * box.height / 2, growth * box.width, growth * box.height};
}

}  // namespace

void CategoryFollower::Restart(const cv::Mat& grey, std::vector<FoundCategory> found) {
  boxes_ = std::move(found);
  before_.reset();
  if (!boxes_.empty()) before_.emplace(grey);
}

std::vector<FoundCategory> CategoryFollower::Follow(const cv::Mat& grey,
                                                    const std::optional<Similarity2>& now_from_before) {
  if (!before_) return {};
  constexpr double kMinInside = 0.5;  // of a box in the frame: less has left it
  FlowPyramid now(grey);
  std::vector<Eigen::Vector2d> points;
  for (const FoundCategory& one : boxes_) AddPoints(one.box, points);
  std::vector<Eigen::Vector2d> guesses = points;
  if (now_from_before) {
    for (Eigen::Vector2d& point : guesses) point = now_from_before->Apply(point);
  }
  const auto tracked = TrackPointsForwardBackward(*before_, now, points, guesses);
  const Box frame = FrameBox(grey.cols, grey.rows);
  std::vector<FoundCategory> kept;
  std::vector<FoundCategory> inside;
  for (std::size_t b = 0; b < boxes_.size(); ++b) {
    const auto moved = MoveBox(boxes_[b].box, std::span(points).subspan(b * kPoints, kPoints),
                               std::span(tracked).subspan(b * kPoints, kPoints));
    if (!moved || Intersection(*moved, frame).Area() < kMinInside * moved->Area()) continue;
    kept.push_back(boxes_[b]);
    kept.back().box = *moved;
    kept.back().is_tracked = true;
    inside.push_back(kept.back());
    inside.back().box = Intersection(*moved, frame);
  }
  boxes_ = std::move(kept);
  before_.reset();
  if (!boxes_.empty()) before_.emplace(std::move(now));
  return inside;
}

}  // namespace victorious

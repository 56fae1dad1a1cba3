#include "victorious/track/appearance.h"

#include <algorithm>
#include <cstddef>

#include <opencv2/core.hpp>

#include "victorious/track/cell_features.h"

namespace victorious {
namespace {

constexpr double kLookArea_px = 1024;  // 64 cells: separates similar cars, yet tolerates small rotations
constexpr std::size_t kMostLooks = 24;
constexpr double kSame = 0.9;  // a template with at least this NCC to a stored one is redundant

double Likest(const std::deque<cv::Mat>& looks, const cv::Mat& look) {
  double best = -1;
  for (const cv::Mat& one : looks) best = std::max(best, one.dot(look));
  return best;
}

}  // namespace

Appearance::Appearance(const Levels& image, const TurnedBox& box)
    : look_px_(WholeCells(box.width, box.height, kLookArea_px)) {
  looks_.push_back(Look(image, box));
}

// All channels, each minus its mean, as one vector of norm 1.
cv::Mat Appearance::Look(const Levels& image, const TurnedBox& box) const {
  const cv::Mat cut = CutOut(image, box, look_px_);
  CellFeatures channels = GradientCells(cut);
  for (cv::Mat& colour : ColourCells(cut)) channels.push_back(std::move(colour));
  cv::Mat look;
  for (const cv::Mat& channel : channels) {
    look.push_back(cv::Mat(channel - cv::mean(channel)[0]).reshape(1, static_cast<int>(channel.total())));
  }
  cv::normalize(look, look);
  return look;
}

double Appearance::Likeness(const Levels& image, const TurnedBox& box) const {
  return Likest(looks_, Look(image, box));
}

void Appearance::Remember(const Levels& image, const TurnedBox& box) {
  const cv::Mat look = Look(image, box);
  if (Likest(looks_, look) >= kSame) return;
  looks_.push_back(look);
  if (looks_.size() > kMostLooks) looks_.erase(looks_.begin() + 1);
}

}  // namespace victorious

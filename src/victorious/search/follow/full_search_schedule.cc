#include "victorious/search/follow/full_search_schedule.h"

#include <algorithm>
#include <cmath>

#include "victorious/search/follow/image_motion.h"
#include "victorious/types/searched_frames.h"

namespace victorious {
namespace {

constexpr double kMinMotion = 0.03;  // fraction of the frame's diagonal
constexpr double kMaxInterval_s = 1;
constexpr std::size_t kViewParts = 3;
constexpr double kScheduleRounding_s = 1e-3;
constexpr double kFrameRounding = 0.5;

}  // namespace

int PartInterval(int interval) { return std::max(1, static_cast<int>(std::lround(kPartSpacing * interval))); }

bool IsFullSearchFrame(std::int64_t frame, int interval, const FollowOptions& options) {
  const int restart = options.enabled ? options.restart_interval_frames : 0;
  return SearchedFrames{.every = interval, .restart = restart}.Contains(frame);
}

double SearchSpacing(const cv::Size& searched) {
  constexpr double kPixels = 1280.0 * 720;
  constexpr double kMaxSpacing = 3;
  return std::clamp(static_cast<double>(searched.area()) / kPixels, 1.0, kMaxSpacing);
}

FullSearchSchedule::FullSearchSchedule(int interval, const FollowOptions& follow, bool by_motion)
    : follow_(follow),
      by_motion_(by_motion),
      by_parts_(by_motion && interval > 1),
      spacing_(by_parts_ ? kPartSpacing : 1),
      interval_(by_parts_ ? PartInterval(interval) : interval) {}

bool FullSearchSchedule::Enter(const Frame& frame, const std::optional<Similarity2>& now_from_before, double spacing) {
  const bool restarts = follow_.enabled && frame.index % follow_.restart_interval_frames == 0;
  if (restarts) next_part_ = static_cast<std::size_t>(frame.index / follow_.restart_interval_frames);
  if (restarts || !now_from_before || !now_from_searched_) {
    now_from_searched_.reset();
  } else {
    now_from_searched_ = *now_from_before * *now_from_searched_;
  }
  if (!MayBeSearched(frame.index)) return false;
  if (!by_motion_ || !now_from_searched_) return true;
  const double longer = spacing_ * spacing;
  const auto frames = static_cast<double>(frame.index - searched_frame_);
  if (spacing > 1 && frames + kFrameRounding < spacing * interval_) return false;
  return frame.time_s - searched_time_s_ > longer * kMaxInterval_s - kScheduleRounding_s ||
         FractionMoved(*now_from_searched_, frame.image.size()) >= longer * kMinMotion;
}

ViewPart FullSearchSchedule::SetSearched(const Frame& frame, bool is_first) {
  searched_time_s_ = frame.time_s;
  searched_frame_ = frame.index;
  now_from_searched_.emplace();
  if (!by_parts_ || is_first) return {};
  return {.index = next_part_++ % kViewParts, .count = kViewParts};
}

}  // namespace victorious

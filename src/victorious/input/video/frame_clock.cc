#include "victorious/input/video/frame_clock.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace victorious {

FrameClock::FrameTime FrameClock::Next(std::optional<std::int64_t> pts, double duration_s,
                                       const NextStampFunction& next_stamp) {
  if (duration_s <= 0) duration_s = default_duration_s_;
  if (!pts) return Advance(end_time_s(), duration_s, false);
  if (!origin_ticks_) origin_ticks_ = static_cast<double>(*pts) - end_time_s() / tick_s_;
  const double time_s = TimeFromStamp(*pts);
  if (started_ && time_s <= last_time_s_) {
    offset_s_ += last_time_s_ + last_duration_s_ / 2 - time_s;
    return Advance(last_time_s_ + last_duration_s_ / 2, duration_s, true);
  }
  const bool leaves_gap = started_ && time_s > end_time_s() + last_duration_s_;
  const auto next = leaves_gap && next_stamp ? next_stamp() : std::nullopt;
  const double next_s = next ? TimeFromStamp(*next) : time_s;
  if (next_s > last_time_s_ && next_s < time_s) {
    return Advance(std::min(end_time_s(), (last_time_s_ + next_s) / 2), duration_s, true);
  }
  if (IsAfterLastFrame(*pts)) offset_s_ = 0;
  return Advance(time_s, duration_s, false);
}

std::optional<double> FrameClock::origin_s() const {
  if (!origin_ticks_) return std::nullopt;
  return *origin_ticks_ * tick_s_;
}

// True if a stamp is after the last frame without the offset offset_s_.
bool FrameClock::IsAfterLastFrame(std::int64_t pts) const {
  return !started_ || (static_cast<double>(pts) - *origin_ticks_) * tick_s_ > last_time_s_;
}

double FrameClock::TimeFromStamp(std::int64_t pts) const {
  return (static_cast<double>(pts) - *origin_ticks_) * tick_s_ + (IsAfterLastFrame(pts) ? 0 : offset_s_);
}

FrameClock::FrameTime FrameClock::Advance(double time_s, double duration_s, bool repaired) {
  // For very large times half a frame is below the precision of a double: use the next double.
  if (started_) time_s = std::max(time_s, std::nextafter(last_time_s_, std::numeric_limits<double>::max()));
  started_ = true;
  last_time_s_ = time_s;
  last_duration_s_ = duration_s;
  return {time_s, repaired};
}

}  // namespace victorious

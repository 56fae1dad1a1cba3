#include "victorious/video/frame_clock.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace victorious {

FrameClock::Reading FrameClock::Next(std::optional<std::int64_t> pts, double duration_s) {
  if (duration_s <= 0) duration_s = default_duration_s_;
  if (!pts) return Advance(end_time_s(), duration_s, false);
  const auto ticks = static_cast<double>(*pts);
  if (!origin_ticks_) origin_ticks_ = ticks - end_time_s() / tick_s_;
  const double time_s = (ticks - *origin_ticks_) * tick_s_;
  if (!started_ || time_s > last_time_s_) {
    shift_s_ = 0;
    return Advance(time_s, duration_s, false);
  }
  if (time_s + shift_s_ > last_time_s_) return Advance(time_s + shift_s_, duration_s, false);
  shift_s_ = last_time_s_ + last_duration_s_ / 2 - time_s;
  return Advance(last_time_s_ + last_duration_s_ / 2, duration_s, true);
}

std::optional<double> FrameClock::origin_s() const {
  if (!origin_ticks_) return std::nullopt;
  return *origin_ticks_ * tick_s_;
}

FrameClock::Reading FrameClock::Advance(double time_s, double duration_s, bool repaired) {
  // So far out that half a frame is below the precision of a double, only the next double is later.
  if (started_) time_s = std::max(time_s, std::nextafter(last_time_s_, std::numeric_limits<double>::max()));
  started_ = true;
  last_time_s_ = time_s;
  last_duration_s_ = duration_s;
  return {time_s, repaired};
}

}  // namespace victorious

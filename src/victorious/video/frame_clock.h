// Private to video/: from the time stamps of decoded frames to strictly increasing seconds since the first frame.
//
//   time_s = (pts - pts of the first frame) * tick_s
//
// A frame without a stamp follows the last one by its duration. A stamp that does not go forwards is damage: the frame
// follows the last one by half its duration, so that the next good stamp fits again; if the stamps go on from there
// (two recordings joined), their spacing is kept. A stamp far ahead is a gap, unless the one after it comes back into
// the gap: then it is damage, too, and the frame takes the place between its neighbours.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

namespace victorious {

class FrameClock {
 public:
  struct Reading {
    double time_s = 0;
    bool repaired = false;  ///< the stamp was damaged
  };

  /// @param tick_s               seconds a unit of the time stamps
  /// @param default_duration_s   of a frame that does not say how long it is shown
  FrameClock(double tick_s, double default_duration_s) : tick_s_(tick_s), default_duration_s_(default_duration_s) {}

  /// The stamp of the frame after this one; nothing if there is none. Asked for only where a stamp leaves a gap.
  using Following = std::function<std::optional<std::int64_t>()>;

  /// The next frame in order of presentation.
  /// @param duration_s  of this frame; 0 if unknown
  Reading Next(std::optional<std::int64_t> pts, double duration_s, const Following& following = {});

  /// The next frame is not the one after the last: its stamp tells its time, whatever came before.
  void Jump() {
    started_ = false;
    shift_s_ = 0;
  }

  /// The first frame's time on the container's clock; nothing before the first stamped frame.
  [[nodiscard]] std::optional<double> origin_s() const;

  [[nodiscard]] double last_time_s() const { return last_time_s_; }
  /// When the last frame's showing ends.
  [[nodiscard]] double end_time_s() const { return started_ ? last_time_s_ + last_duration_s_ : 0; }

 private:
  [[nodiscard]] bool IsUnshifted(std::int64_t pts) const;
  [[nodiscard]] double TimeOf(std::int64_t pts) const;
  Reading Advance(double time_s, double duration_s, bool repaired);

  double tick_s_;
  double default_duration_s_;
  std::optional<double> origin_ticks_;
  bool started_ = false;
  double last_time_s_ = 0;
  double last_duration_s_ = 0;
  double shift_s_ = 0;  ///< added to stamps that started anew at an earlier time
};

}  // namespace victorious

// Private to video/: converts the time stamps of decoded frames to strictly increasing seconds since the first frame.
//
//   time_s = (pts - pts of the first frame) * tick_s
//
// - Missing stamp: the frame follows the previous one by that frame's duration.
// - Non-increasing stamp: damage. The frame follows the previous one by half its duration, so that the next correct
//   stamp is again increasing. If the stamps continue from there (two concatenated recordings), their spacing is kept
//   by an offset.
// - Stamp far ahead: a gap, unless the next stamp lies inside the gap. Then the stamp is damaged, and the frame takes
//   the time between its neighbours.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

namespace victorious {

class FrameClock {
 public:
  struct FrameTime {
    double time_s = 0;      ///< since the first frame
    bool repaired = false;  ///< true if the stamp was damaged and replaced
  };

  /// @param tick_s               duration of one unit of the time stamps, s
  /// @param default_duration_s   duration of a frame whose duration is unknown, s
  FrameClock(double tick_s, double default_duration_s) : tick_s_(tick_s), default_duration_s_(default_duration_s) {}

  /// Returns the stamp of the next frame, std::nullopt if there is none. Called only if a stamp leaves a gap.
  using NextStampFunction = std::function<std::optional<std::int64_t>()>;

  /// Returns the time of the next frame in presentation order.
  /// @param pts         its stamp, if it has one
  /// @param duration_s  its duration; 0 if unknown
  FrameTime Next(std::optional<std::int64_t> pts, double duration_s, const NextStampFunction& next_stamp = {});

  /// Resets the sequence after a seek: the time of the next frame follows from its stamp alone.
  void Restart() {
    started_ = false;
    offset_s_ = 0;
  }

  /// Time of the first frame in the container's clock; std::nullopt before the first frame with a stamp.
  [[nodiscard]] std::optional<double> origin_s() const;

  [[nodiscard]] double last_time_s() const { return last_time_s_; }
  /// End of the last frame: its time plus its duration. 0 before the first frame.
  [[nodiscard]] double end_time_s() const { return started_ ? last_time_s_ + last_duration_s_ : 0; }

 private:
  [[nodiscard]] bool IsAfterLastFrame(std::int64_t pts) const;
  [[nodiscard]] double TimeFromStamp(std::int64_t pts) const;
  FrameTime Advance(double time_s, double duration_s, bool repaired);

  double tick_s_;
  double default_duration_s_;
  std::optional<double> origin_ticks_;
  bool started_ = false;
  double last_time_s_ = 0;
  double last_duration_s_ = 0;
  double offset_s_ = 0;  ///< offset of stamps that restarted at an earlier time
};

}  // namespace victorious

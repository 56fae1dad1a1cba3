// Private to video/: recordings that were joined byte by byte, and live sources that began again. The time stamps of
// all streams then begin anew (ISO/IEC 13818-1: a programme has one time base); they are moved so that the second
// recording follows the first.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "victorious/input/video/ffmpeg_handles.h"

namespace victorious {

class TimeBaseJoints {
 public:
  /// @param time_base  of the video's stamps
  explicit TimeBaseJoints(AVRational time_base) : time_base_(time_base) {}

  /// Whether a packet of the video is out of order: of another time base, or with a damaged stamp.
  [[nodiscard]] bool IsOutOfOrder(const AVPacket& packet) const;

  /// Decides this by the packet of the video after it, which goes on from it if the time base is another. Then returns
  /// true and enters the joint.
  bool EnterIfJoint(const AVPacket& packet, const AVPacket& next);

  /// Moves the stamps of the next packet of the video in order of reading.
  void Move(AVPacket& packet);

  /// How much is to be added to the stamp of a data packet, s.
  /// @param time_s    its stamp
  /// @param position  in the file, bytes; -1 if unknown
  /// @param joints    the number of joints that were known when it was read
  [[nodiscard]] double OffsetOf(double time_s, std::int64_t position, std::size_t joints) const;

  [[nodiscard]] std::size_t count() const { return joints_.size(); }

  /// After a seek.
  void Restart() {
    last_stamp_.reset();
    before_last_.reset();
  }

 private:
  struct Joint {
    double end_s = 0;                 ///< the last stamp before it, as read
    double start_s = 0;               ///< the first stamp after it, as read
    std::int64_t end_position = 0;    ///< of the last packet of the video before it
    std::int64_t start_position = 0;  ///< of the first one after it
    double offset_s = 0;              ///< of stamps after it
  };

  [[nodiscard]] double Seconds(std::int64_t stamp) const { return static_cast<double>(stamp) * av_q2d(time_base_); }

  AVRational time_base_;
  std::optional<std::int64_t> last_stamp_;   ///< as read
  std::optional<std::int64_t> before_last_;  ///< the one before it
  std::int64_t last_position_ = -1;
  std::int64_t offset_ = 0;  ///< of the current time base, in units of the video's
  std::vector<Joint> joints_;
};

}  // namespace victorious

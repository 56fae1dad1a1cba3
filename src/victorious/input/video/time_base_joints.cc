#include "victorious/input/video/time_base_joints.h"

#include <algorithm>
#include <cmath>

namespace victorious {
namespace {

// A jump ahead by more than half the range of MPEG-TS's stamps (33 bits at 90 kHz) is one back that FFmpeg takes for an
// overflow.
constexpr double kOverflow_s = 4294967296 / 90'000.0;
// Stamps of 64 bits may have any value.
constexpr double kMaxOffset = 1e15;
constexpr double kMaxStamp = 4e18;

}  // namespace

bool TimeBaseJoints::IsOutOfOrder(const AVPacket& packet) const {
  if (packet.dts == AV_NOPTS_VALUE || !last_stamp_) return false;
  return packet.dts < *last_stamp_ || Seconds(packet.dts) - Seconds(*last_stamp_) > kOverflow_s;
}

bool TimeBaseJoints::EnterIfJoint(const AVPacket& packet, const AVPacket& next) {
  if (next.dts == AV_NOPTS_VALUE || next.dts <= packet.dts) return false;
  // A damaged stamp ahead of its place comes before packets that go on from the one before it.
  if (before_last_ && packet.dts > *before_last_ &&
      Seconds(packet.dts) - Seconds(*before_last_) < Seconds(*last_stamp_) - Seconds(packet.dts)) {
    last_stamp_ = before_last_;
    return false;
  }
  const double interval_s = Seconds(next.dts) - Seconds(packet.dts);
  if (interval_s >= std::abs(Seconds(packet.dts) - Seconds(*last_stamp_))) return false;
  const double duration = packet.duration > 0 ? static_cast<double>(packet.duration) : interval_s / av_q2d(time_base_);
  const double end = static_cast<double>(*last_stamp_) + duration;
  const double change = end - static_cast<double>(packet.dts);
  if (!(std::abs(static_cast<double>(offset_) + change) < kMaxOffset)) return false;
  offset_ += std::llround(change);
  joints_.push_back({.end_s = Seconds(*last_stamp_),
                     .start_s = Seconds(packet.dts),
                     .end_position = last_position_,
                     .start_position = packet.pos,
                     .offset_s = Seconds(offset_)});
  Restart();
  return true;
}

void TimeBaseJoints::Move(AVPacket& packet) {
  if (packet.dts != AV_NOPTS_VALUE && !IsOutOfOrder(packet)) {
    before_last_ = last_stamp_;
    last_stamp_ = packet.dts;
  }
  last_position_ = packet.pos;
  for (std::int64_t* stamp : {&packet.dts, &packet.pts}) {
    if (*stamp == AV_NOPTS_VALUE) continue;
    *stamp = std::abs(static_cast<double>(*stamp)) < kMaxStamp ? *stamp + offset_ : AV_NOPTS_VALUE;
  }
}

double TimeBaseJoints::OffsetOf(double time_s, std::int64_t position, std::size_t joints) const {
  double offset_s = 0;
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const Joint& joint = joints_[i];
    const bool is_positioned = position >= 0 && joint.start_position >= 0;
    bool is_after = is_positioned ? position >= joint.start_position : i < joints;
    // Streams are interleaved: what stands between both packets of the video belongs to the nearer stamp.
    if (is_positioned && !is_after && position > joint.end_position) {
      is_after = std::abs(time_s - joint.start_s) < std::abs(time_s - joint.end_s);
    }
    if (is_after) offset_s = joint.offset_s;
  }
  return offset_s;
}

}  // namespace victorious

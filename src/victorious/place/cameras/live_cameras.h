// Camera states of a live source, decoded from the telemetry packets that arrive with its frames.
//
// Packets are decoded every 0.2 s. A packet without a time stamp gets the time of the newest frame. Of several data
// streams, the first one with camera states is used. Packets and states of the last 30 s are kept: an item
// of a packet holds for the later ones.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/base/warning_list.h"
#include "victorious/input/telemetry/telemetry.h"
#include "victorious/input/video/frame_loop.h"
#include "victorious/types/camera_state.h"
#include "victorious/types/data_packet.h"

namespace victorious {

/// Maximum wait of a frame for telemetry of its time or later: telemetry streams send it at least once a second.
inline constexpr double kMaxLiveWait_s = 1.0;
/// A source that has sent no camera state for so long from its first frame on is not waited for until it sends one.
inline constexpr double kMaxFirstStateWait_s = 3.0;

class LiveCameraTrack final : public PacketReceiver {
 public:
  explicit LiveCameraTrack(TelemetryOptions options) : options_(std::move(options)) {}

  /// Errors: those of the telemetry options.
  [[nodiscard]] Status Add(std::vector<DataPacket> packets, double now_s) override;

  /// True if later packets cannot change the frame's camera state, or after kMaxLiveWait_s.
  [[nodiscard]] bool IsReady(double frame_s, double now_s) const override {
    return Covers(frame_s) || now_s >= frame_s + kMaxLiveWait_s ||
           (!stream_ && first_s_ && now_s >= *first_s_ + kMaxFirstStateWait_s);
  }

  /// True if a state at `time_s` or later has arrived, so that later packets cannot change the state at `time_s`.
  [[nodiscard]] bool Covers(double time_s) const { return !states_.empty() && states_.back().time_s >= time_s; }

  /// Interpolated state, as CameraTrajectory::At.
  [[nodiscard]] std::optional<CameraState> At(double time_s) const;

  /// Warnings, one line each: the first ones, and the number of the others.
  [[nodiscard]] std::vector<std::string> Warnings() const;

 private:
  [[nodiscard]] Status Decode(const std::vector<DataPacket>& packets, int stream);
  void AppendStates(std::span<const CameraState> states);

  TelemetryOptions options_;
  std::map<int, std::vector<DataPacket>> packets_;  // by stream, of the last 30 s
  double decoded_s_ = -1;                           // time of the newest frame at the last decoding
  std::optional<double> first_s_;                   // time of the first frame
  std::optional<int> stream_;                       // the stream with camera states
  std::vector<CameraState> states_;                 // by ascending time
  WarningList warnings_;
  std::set<std::string> warned_;  // their texts without digits
};

}  // namespace victorious

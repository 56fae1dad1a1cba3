#include "victorious/place/cameras/live_cameras.h"

#include <utility>

#include "victorious/input/telemetry/camera_track.h"

namespace victorious {

Status LiveCameraTrack::Add(std::vector<DataPacket> packets, double now_s) {
  constexpr double kDecodeEvery_s = 0.2;
  if (!first_s_) first_s_ = now_s;
  for (DataPacket& packet : packets) {
    if (stream_ && packet.stream != *stream_) continue;
    if (!packet.time_s) packet.time_s = now_s;
    pending_[packet.stream].push_back(std::move(packet));
  }
  if (pending_.empty() || (stream_ && now_s < decoded_s_ + kDecodeEvery_s)) return {};
  decoded_s_ = now_s;
  for (const auto& [stream, of_stream] : std::exchange(pending_, {})) {
    if (!stream_ || stream == *stream_) VICTORIOUS_RETURN_IF_ERROR(Decode(of_stream, stream));
  }
  return {};
}

Status LiveCameraTrack::Decode(const std::vector<DataPacket>& packets, int stream) {
  VICTORIOUS_ASSIGN_OR_RETURN(const Telemetry telemetry, TelemetryFromPackets(packets, options_));
  for (const std::string& warning : telemetry.warnings) warnings_.AddOnce(warning);
  if (telemetry.states.empty()) return {};
  stream_ = stream;
  AppendStates(telemetry.states);
  return {};
}

void LiveCameraTrack::AppendStates(std::span<const CameraState> states) {
  constexpr double kKept_s = 30;
  for (const CameraState& state : states) {
    if (states_.empty() || state.time_s > states_.back().time_s) states_.push_back(state);
  }
  const double oldest_s = states_.back().time_s - kKept_s;
  std::erase_if(states_, [&](const CameraState& state) { return state.time_s < oldest_s; });
}

std::optional<CameraState> LiveCameraTrack::At(double time_s) const {
  return CameraTrajectory(states_, options_.max_gap_s).At(time_s);
}

std::vector<std::string> LiveCameraTrack::Warnings() const {
  std::vector<std::string> lines = warnings_.Lines();
  if (!stream_) {
    lines.emplace_back(
        "the live source carries no telemetry with camera position, attitude and field of view: objects get no place");
  }
  return lines;
}

}  // namespace victorious

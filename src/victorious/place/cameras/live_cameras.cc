#include "victorious/place/cameras/live_cameras.h"

#include <cctype>
#include <utility>

#include "victorious/input/telemetry/camera_track.h"

namespace victorious {
namespace {

// States and packets of this time stay: an item of a packet holds as long (klv_hold.h).
constexpr double kKept_s = 30;

}  // namespace

Status LiveCameraTrack::Add(std::vector<DataPacket> packets, double now_s) {
  constexpr double kDecodeEvery_s = 0.2;
  if (!first_s_) first_s_ = now_s;
  for (DataPacket& packet : packets) {
    if (stream_ && packet.stream != *stream_) continue;
    if (!packet.time_s) packet.time_s = now_s;
    packets_[packet.stream].push_back(std::move(packet));
  }
  if (packets_.empty() || now_s < decoded_s_ + kDecodeEvery_s) return {};
  decoded_s_ = now_s;
  for (auto& [stream, kept] : packets_) {
    if (stream_ && stream != *stream_) continue;
    std::erase_if(kept, [&](const DataPacket& packet) { return *packet.time_s < now_s - kKept_s; });
    VICTORIOUS_RETURN_IF_ERROR(Decode(kept, stream));
  }
  if (stream_) std::erase_if(packets_, [&](const auto& one) { return one.first != *stream_; });
  return {};
}

Status LiveCameraTrack::Decode(const std::vector<DataPacket>& packets, int stream) {
  VICTORIOUS_ASSIGN_OR_RETURN(const Telemetry telemetry, TelemetryFromPackets(packets, options_));
  for (const std::string& warning : telemetry.warnings) {
    std::string kind = warning;  // the numbers in it differ each time
    std::erase_if(kind, [](unsigned char c) { return std::isdigit(c) != 0; });
    if (warned_.insert(std::move(kind)).second) warnings_.AddOnce(warning);
  }
  if (telemetry.states.empty()) return {};
  stream_ = stream;
  AppendStates(telemetry.states);
  return {};
}

void LiveCameraTrack::AppendStates(std::span<const CameraState> states) {
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

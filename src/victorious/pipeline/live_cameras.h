// The camera's states of a live source, from the telemetry that comes beside its frames.
//
// What comes is decoded a few times a second. What carries no time of its own is of the moment at which it came; of
// several streams the first that tells of a camera counts. Only the last seconds are kept.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/telemetry/telemetry.h"
#include "victorious/types/camera_state.h"
#include "victorious/types/data_packet.h"

namespace victorious {

class LiveCameras {
 public:
  explicit LiveCameras(TelemetryOptions options) : options_(std::move(options)) {}

  /// @param packets  what came since the last call
  /// @param now_s    of the newest frame
  /// Errors: those of the options.
  Status Add(std::vector<DataPacket> packets, double now_s);

  /// Whether all is known of this moment: what is still to come is of later ones.
  [[nodiscard]] bool Covers(double time_s) const { return !states_.empty() && states_.back().time_s >= time_s; }

  /// As CameraTrack::At.
  [[nodiscard]] std::optional<CameraState> At(double time_s) const;

  /// What was not as it should be, a line each.
  [[nodiscard]] std::vector<std::string> Warnings() const;

 private:
  Status Decode(const std::vector<DataPacket>& packets, int stream);
  void Take(std::span<const CameraState> states);

  TelemetryOptions options_;
  std::map<int, std::vector<DataPacket>> pending_;  // by stream, not yet decoded
  double decoded_s_ = 0;                            // of the newest frame when they last were
  std::optional<int> stream_;                       // that tells of the camera
  std::vector<CameraState> states_;                 // by rising time
  std::vector<std::string> warnings_;
};

}  // namespace victorious

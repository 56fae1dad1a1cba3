// A KLV packet's items as a camera's state.
//
// ST 0601 gives the platform's attitude and, against it, the sensor's, each as three turns about the axes of a body
// (forward, right, down):  ned_from_sensor = Rz(heading) Ry(pitch) Rx(roll)  Rz(azimuth) Ry(elevation) Rx(roll).
// The camera's optical axis is the sensor's forward axis, its image's right side the sensor's right. EG 0104 gives the
// optical axis itself. Full-range items go before the older ones, heights above the ellipsoid before those above the
// sea.
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "victorious/telemetry/klv_packet.h"
#include "victorious/types/camera_state.h"

namespace victorious {

/// With the packet's own datum and time of day, and `time_s` as the container has it (0 if it has none). Nothing where
/// the packet lacks a place, a height or where the sensor points, says that it does not know it, or fails its checksum.
[[nodiscard]] std::optional<CameraState> CameraFromKlv(const KlvPacket& packet);

/// What of a camera's state no packet tells, in plain words: "the platform's heading (item 5)"; ST 0601's packets
/// alone.
[[nodiscard]] std::vector<std::string_view> MissingForCamera(std::span<const KlvPacket> packets);

/// The angle at the camera between its line of sight and the frame centre that the same packet records, radians;
/// nothing where either is missing. Large angles mean that an item is not what the standard calls it.
[[nodiscard]] std::optional<double> FrameCentreError(const KlvPacket& packet);

}  // namespace victorious

// telemetry/: from the items of a KLV packet to a camera state.
//
// ST 0601 gives the platform's attitude and the sensor's attitude relative to it, each as three rotations about body
// axes (forward, right, down):  ned_from_sensor = Rz(heading) Ry(pitch) Rx(roll)  Rz(azimuth) Ry(elevation) Rx(roll).
// The camera's optical axis is the sensor's forward axis; the image's right is the sensor's right. EG 0104 gives the
// optical axis directly. Full-range items take precedence over the older ones, heights above the ellipsoid over heights
// above mean sea level.
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "victorious/input/telemetry/klv_packet.h"
#include "victorious/types/camera_state.h"

namespace victorious {

/// The camera state, with the packet's own vertical datum and UTC time, and the container's `time_s` (0 if it has
/// none).
/// @return std::nullopt if the packet lacks the position, the height or the sensor's pointing, marks one as unknown, or
///   fails its checksum
[[nodiscard]] std::optional<CameraState> CameraFromKlv(const KlvPacket& packet);

/// Descriptions of the items that a camera state needs and no packet has, such as "the platform's heading (item 5)".
/// For ST 0601 packets only.
[[nodiscard]] std::vector<std::string_view> FindMissingCameraItems(std::span<const KlvPacket> packets);

/// The angle at the camera between its optical axis and the frame centre that the same packet records, radians;
/// std::nullopt if either is missing. A large angle shows that the producer does not follow the standard.
[[nodiscard]] std::optional<double> ComputeFrameCentreError(const KlvPacket& packet);

}  // namespace victorious

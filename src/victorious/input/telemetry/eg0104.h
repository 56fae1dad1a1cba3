// telemetry/: MISB EG 0104 (Predator UAV Basic Universal Metadata Set), the predecessor of ST 0601. Each item has its
// own 16-byte label; numbers are IEEE floats.
#pragma once

#include <optional>
#include <string_view>

#include "victorious/input/telemetry/klv.h"
#include "victorious/input/telemetry/klv_packet.h"

namespace victorious {

[[nodiscard]] bool IsEg0104Label(Bytes label);

/// Decodes the items; each has `number` 0 and its label. Never fails: decodes as far as possible and describes the rest
/// in `problem`.
[[nodiscard]] KlvPacket DecodeEg0104(const KlvUnit& unit);

/// Names, as DecodeEg0104 gives them, of the items that a camera state needs.
namespace eg0104 {
inline constexpr std::string_view kTimeStamp = "User Defined Time Stamp";
inline constexpr std::string_view kLatitude = "Device Latitude";
inline constexpr std::string_view kLongitude = "Device Longitude";
inline constexpr std::string_view kAltitude = "Device Altitude";
inline constexpr std::string_view kHorizontalFieldOfView = "Field of View (Horizontal)";
inline constexpr std::string_view kAngleToNorth = "Angle to North";
inline constexpr std::string_view kObliquityAngle = "Obliquity Angle";
inline constexpr std::string_view kSensorRoll = "Sensor Roll Angle";
inline constexpr std::string_view kFrameCenterLatitude = "Frame Center Latitude";
inline constexpr std::string_view kFrameCenterLongitude = "Frame Center Longitude";
inline constexpr std::string_view kFrameCenterElevation = "Frame Center Elevation";
inline constexpr std::string_view kSlantRange = "Slant Range";
}  // namespace eg0104

/// The numeric value of the item of this name; std::nullopt if the packet lacks it.
[[nodiscard]] std::optional<double> FindNumber(const KlvPacket& packet, std::string_view name);

}  // namespace victorious

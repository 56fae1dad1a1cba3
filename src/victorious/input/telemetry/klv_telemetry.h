// Private to telemetry/: decoded KLV packets to camera states and warnings.
#pragma once

#include "victorious/input/telemetry/klv_packets.h"
#include "victorious/input/telemetry/telemetry.h"

namespace victorious {

/// The states of the camera's stream, in the order of its packets, each with its own datum.
/// @param max_gap_s  the longest interval over which packets complete each other
[[nodiscard]] Telemetry TelemetryFromKlv(KlvPackets decoded, double max_gap_s);

}  // namespace victorious

// Private to telemetry/: of several KLV streams in one video, selects that of the camera, and completes its packets.
//
// A container may have a stream for each sensor, and others for security, targets or the platform alone. The stream of
// the camera is the one with the most packets that have its position, height and pointing. Streams of other cameras are
// not mixed in; one that is no camera by itself completes the packets of the chosen stream.
#pragma once

#include <span>
#include <vector>

#include "victorious/input/telemetry/klv_packet.h"

namespace victorious {

struct CameraStream {
  int stream = 0;
  std::vector<KlvPacket> packets;  ///< of this stream, in order, completed
  std::vector<int> completed_by;   ///< the streams that gave items, ascending
  bool has_others = false;         ///< whether other streams have packets of a known standard
};

/// Completes the packets of each stream by the others of it (klv_hold.h). Then selects the stream by the number of
/// packets that give a camera state; of equal ones, by those with a sensor pointing, then by those of a known standard.
/// An ST 0601 item that the stream lacks altogether is taken from the packets of a stream without camera states:
/// position and height interpolated between the packets before and after, other items from the nearest packet, at most
/// `max_gap_s` away. Packets without a time, and those that fail their checksum, complete nothing.
/// @param sent  the packets of all streams; empty: the result has no packets
CameraStream SelectCameraStream(std::span<const KlvPacket> sent, double max_gap_s);

}  // namespace victorious

// Private to telemetry/: values of KLV items between the packets that send them.
//
// No packet needs to have all items: a producer may send some only when they change, or in turn (ST 0902 asks for each
// at least once in 30 s). A value holds until it is sent again, or withdrawn by an item without a value. Where it is
// sent again within a short time, position and angles are interpolated instead.
#pragma once

#include <vector>

#include "victorious/input/telemetry/klv_packet.h"

namespace victorious {

/// Adds to each packet the items of a camera that it lacks, from other packets of its stream. Of items that say the
/// same (three heights), none is added if the packet has one of them, and else the one that was sent last. Packets
/// without a time, and those that fail their checksum, neither give nor get items.
/// @param packets    in order of their streams
/// @param max_gap_s  the longest interval between two values that are interpolated
void HoldItems(std::vector<KlvPacket>& packets, double max_gap_s);

}  // namespace victorious

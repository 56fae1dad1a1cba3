// Sightings of one video as VMTI: a packet of KLV for each frame that has any (vmti_packet.h).
#pragma once

#include "victorious/show/export/export_format.h"

namespace victorious {

/// Bare KLV, in the order of time. Errors: kInvalidArgument with more than one video, or one whose UTC is not known:
/// packets have no other time.
extern const ExportFormat kVmtiFormat;

}  // namespace victorious

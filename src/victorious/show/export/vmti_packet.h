// Moving targets of a frame as KLV: MISB ST 0903 (VMTI Local Set) inside a packet of MISB ST 0601, as players and
// exploitation systems of full-motion video read them.
//
// Of ST 0903.5: items 3 (system), 4 (version), 5 and 6 (targets), 7 (frame), 8 and 9 (size of the frame) and 101, a
// VTarget pack for each target, with its centroid (1), box (2, 3), confidence (5), place (17) and class (102: VObject).
// Of ST 0601.19: items 2 (UTC), 65 (version), 74 (the VMTI set) and 1 (checksum). Reals are mapped by ST 1201 (IMAPB).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "victorious/geometry/box.h"
#include "victorious/types/geolocation.h"

namespace victorious {

/// The name of the system that found the targets.
inline constexpr std::string_view kVmtiSystem = "VICTORIOUS";

/// What says of which ontology the classes are: the names of models and categories as their user gave them.
inline constexpr std::string_view kVmtiOntology = "urn:victorious:models";

struct VmtiTarget {
  std::int64_t id = 0;    ///< from 1
  Box box;                ///< px; clipped to the frame when written; a target outside of it is left out
  double confidence = 0;  ///< 0 to 1
  std::string label;      ///< its class
  /// Left out if it is not finite or beyond the standard's range; its errors alone if they are.
  std::optional<Geolocation> place;
};

struct VmtiFrame {
  std::int64_t utc_us = 0;  ///< microseconds since 1970
  std::int64_t frame = 0;   ///< from 0
  int width = 0;            ///< px; without a size the frame has no targets
  int height = 0;           ///< px
  std::vector<VmtiTarget> targets;
};

/// One packet: label, length, value.
[[nodiscard]] std::vector<std::byte> EncodeVmti(const VmtiFrame& frame);

/// The forward mapping of ST 1201 of a number to so many bytes, big-endian. Beyond [min, max] that of the nearer bound;
/// NaN is the standard's quiet NaN.
[[nodiscard]] std::vector<std::byte> EncodeImapb(double value, double min, double max, int bytes);

}  // namespace victorious

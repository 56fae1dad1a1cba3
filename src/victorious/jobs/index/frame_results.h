// What the search of one frame gives to the linking of tracklets: all that the linking reads, so that it can run later,
// in another process, and give the same tracklets.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/geometry/similarity.h"
#include "victorious/types/index_records.h"

namespace victorious {

struct FrameResult {
  std::int64_t frame = 0;
  bool is_whole = false;                       ///< the whole frame was searched
  std::optional<Similarity2> now_from_before;  ///< camera motion from the previous frame
  std::vector<SightingRecord> sightings;       ///< without tracklets and objects
};

/// The results as bytes (base/packed_bytes.h). Numbers keep every bit.
[[nodiscard]] std::vector<std::byte> PackFrameResults(std::span<const FrameResult> results);

/// Safe for any bytes. Error: kDataLoss for bytes that PackFrameResults did not make.
[[nodiscard]] Expected<std::vector<FrameResult>> UnpackFrameResults(std::span<const std::byte> bytes);

}  // namespace victorious

// Shared by the implementations of FindShortNearest. A key is a partial distance (without |q|^2) of shortened
// descriptors and the number of the block in its segment: of two keys, the smaller one is the nearer, of equal
// distances the one of the lower block. A partial distance is |b|^2 - 2 q.b, within +- 32 255^2 < 2^21.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "victorious/kernels/nearest.h"

namespace victorious::kernels {

inline constexpr int kBlockBits = 10;
static_assert(kSegmentBlocks == 1U << kBlockBits);
inline constexpr std::int32_t kNoKey = std::numeric_limits<std::int32_t>::max();
/// The constant of padding among shortened descriptors, whose products are zero: the key is above all others.
inline constexpr std::int32_t kShortPaddingDistance = kNoKey >> kBlockBits;

/// The running k nearest of one query over the segments of its range.
class ShortNearest {
 public:
  explicit ShortNearest(std::size_t k) : k_(k) { std::fill_n(nearest_, kMaxNeighbours, kNone); }

  /// Adds a descriptor if it is nearer than the k-th; false if it is not.
  /// @param segment  the first block of the segment
  bool Add(std::int32_t key, std::size_t segment, std::size_t lane) {
    if (key >> kBlockBits == kShortPaddingDistance) return false;
    const std::size_t block = segment + (static_cast<std::uint32_t>(key) & (kSegmentBlocks - 1));
    const std::uint32_t index = static_cast<std::uint32_t>(block * kBlockDescriptors + lane);
    const std::int64_t value = (static_cast<std::int64_t>(key >> kBlockBits) << 32) | index;
    if (value >= nearest_[k_ - 1]) return false;
    std::size_t place = k_ - 1;
    for (; place > 0 && value < nearest_[place - 1]; --place) nearest_[place] = nearest_[place - 1];
    nearest_[place] = value;
    return true;
  }

  void Write(std::uint32_t* out) const {
    for (std::size_t i = 0; i < k_; ++i)
      out[i] = nearest_[i] == kNone ? kNoNeighbour : static_cast<std::uint32_t>(nearest_[i]);
  }

 private:
  static constexpr std::int64_t kNone = std::numeric_limits<std::int64_t>::max();

  std::size_t k_;
  std::int64_t nearest_[kMaxNeighbours];  // partial distance, then index
};

}  // namespace victorious::kernels

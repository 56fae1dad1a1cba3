// The layout that nearest.h and short_nearest.h search: descriptors in blocks of 16, interleaved in groups of 4 bytes,
//   block[row bytes / 4 groups][16 descriptors][4 bytes]
// so that one load serves 16 descriptors.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <new>
#include <span>
#include <vector>

namespace victorious::kernels {

inline constexpr std::size_t kBlockDescriptors = 16;
inline constexpr std::size_t kGroupBytes = 4;

/// Aligns to cache lines: a load of 64 bytes that crosses from one into the next takes twice as long.
template <typename T>
class BlockAllocator {
 public:
  using value_type = T;

  BlockAllocator() = default;
  template <typename Other>
  explicit BlockAllocator(const BlockAllocator<Other>&) {}

  T* allocate(std::size_t count) { return static_cast<T*>(::operator new(count * sizeof(T), kAlignment)); }
  void deallocate(T* values, std::size_t) { ::operator delete(values, kAlignment); }

  bool operator==(const BlockAllocator&) const = default;

 private:
  static constexpr std::align_val_t kAlignment{64};
};
template <typename T>
using BlockVector = std::vector<T, BlockAllocator<T>>;

/// Writes a descriptor to its place in the blocks.
inline void InterleaveRow(std::span<const std::uint8_t> row, std::size_t descriptor, std::uint8_t* blocks) {
  std::uint8_t* const lane = blocks + (descriptor / kBlockDescriptors) * kBlockDescriptors * row.size() +
                             (descriptor % kBlockDescriptors) * kGroupBytes;
  for (std::size_t at = 0; at < row.size(); at += kGroupBytes) {
    std::memcpy(lane + at * kBlockDescriptors, row.data() + at, kGroupBytes);
  }
}

}  // namespace victorious::kernels

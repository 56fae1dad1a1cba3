// kernels/, the hot loops of match/: for each query descriptor the nearest and second nearest of a set, or the k
// nearest, by squared Euclidean distance. Exhaustive and exact.
//
// The set is packed once into blocks of 16 descriptors, interleaved in groups of 4 bytes:
//   block[32 groups][16 descriptors][4 bytes]
// so that one load serves 16 descriptors, and 16 lanes accumulate 16 distances without horizontal additions. With
// d = |q - b|^2 = |q|^2 + |b|^2 - 2 q.b the loop computes only q.b; all arithmetic is exact in 32 bits.
//
// FindShortNearest searches sets of shortened descriptors (shorten.h), only a range of blocks per tile of queries, and
// without branches: approximate, by a definition that all implementations share.
//
// nearest_ref.cc is the reference; nearest_simd.cc (Highway, every instruction set) and nearest_vnni.cc (x86-64 with
// AVX-512 VNNI) return identical bits. C++20: no <expected> here.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace victorious::kernels {

inline constexpr std::size_t kDescriptorBytes = 128;
inline constexpr std::size_t kShortBytes = 32;  ///< of a shortened descriptor
inline constexpr std::size_t kBlockDescriptors = 16;
inline constexpr std::size_t kBlockBytes = kBlockDescriptors * kDescriptorBytes;  ///< of whole descriptors
inline constexpr std::uint32_t kNoDistance = 0xFFFFFFFF;

/// A packed set of descriptors. The last block is padded; padding is never returned.
struct PackedDescriptors {
  std::size_t count = 0;
  std::size_t row_bytes = kDescriptorBytes;  ///< or kShortBytes
  /// kBlockDescriptors x row_bytes a block (64-byte alignment is not needed: loads are unaligned)
  std::vector<std::uint8_t> blocks;
  std::vector<std::int32_t> constant;  ///< per descriptor: |b|^2 - 256 sum(b); for padding: kPaddingDistance

  [[nodiscard]] std::size_t block_count() const { return constant.size() / kBlockDescriptors; }
};

/// @param rows       row_bytes per descriptor
/// @param row_bytes  kDescriptorBytes or kShortBytes
PackedDescriptors Pack(std::span<const std::uint8_t> rows, std::size_t row_bytes = kDescriptorBytes);

/// The two nearest descriptors of one query.
struct NearestTwo {
  std::uint32_t best_index = 0;                  ///< of the smallest distance; the lowest index of equal distances
  std::uint32_t best_distance2 = kNoDistance;    ///< squared; kNoDistance for an empty set
  std::uint32_t second_distance2 = kNoDistance;  ///< squared, of another descriptor; kNoDistance for a set of one

  bool operator==(const NearestTwo&) const = default;
};

/// Queries converted once and searched in many sets.
struct PackedQueries {
  std::size_t count = 0;
  std::size_t row_bytes = kDescriptorBytes;  ///< or kShortBytes
  std::vector<std::int8_t> rows;             ///< row_bytes per query: q - 128
  std::vector<std::int32_t> squared;         ///< |q|^2
};

/// @param rows       row_bytes per query
/// @param row_bytes  kDescriptorBytes or kShortBytes
PackedQueries PackQueries(std::span<const std::uint8_t> rows, std::size_t row_bytes = kDescriptorBytes);

/// Writes the result of query i to out[i]; out.size() == queries.count. Uses this machine's fastest implementation.
/// Cost: queries x set x 128 multiplications; AVX-512 VNNI does 64 per instruction.
void FindNearestTwo(const PackedQueries& queries, const PackedDescriptors& set, std::span<NearestTwo> out);

/// The implementation that FindNearestTwo uses on this machine: "avx512_vnni", or Highway's target name.
const char* NearestTwoTarget();

/// One of the k nearest descriptors of a query.
struct Neighbour {
  std::uint32_t index = 0;
  std::uint32_t distance2 = kNoDistance;  ///< squared; kNoDistance if the set has fewer descriptors

  bool operator==(const Neighbour&) const = default;
};

inline constexpr std::size_t kMaxNeighbours = 8;

/// The k nearest descriptors of query i in out[k i] to out[k i + k - 1], nearest first; of equal
/// distances the lower index first. 1 <= k <= kMaxNeighbours; out.size() == k * queries.count.
/// Cost: that of FindNearestTwo.
void FindNearestK(const PackedQueries& queries, const PackedDescriptors& set, std::size_t k, std::span<Neighbour> out);

/// The blocks [first, last) of a set.
struct BlockRange {
  std::size_t first = 0;
  std::size_t last = 0;
};

/// Consecutive queries that share a range: the largest tile of an implementation.
inline constexpr std::size_t kRangeQueries = 8;

/// Blocks of a segment: a range is searched segment by segment.
inline constexpr std::size_t kSegmentBlocks = 1024;

inline constexpr std::uint32_t kNoNeighbour = 0xFFFFFFFF;

/// For each query i of shortened descriptors the indices of the nearest k in the blocks ranges[i / kRangeQueries], in
/// out[k i] to out[k i + k - 1]: nearest first, of equal distances the lower index first, kNoNeighbour if there are
/// fewer. Of each lane (index modulo 16) of each segment of a range only the two nearest are considered, so that the
/// loop has no branches; of the nearest four of a hundred random ones 99 % are among them.
/// 1 <= k <= kMaxNeighbours; ranges.size() >= queries.count / kRangeQueries, rounded up; each range lies inside the
/// set; queries.squared is not used.
/// Cost: that of FindNearestTwo, times the fraction of the set that the ranges cover, times kShortBytes / 128.
void FindShortNearest(const PackedQueries& queries, const PackedDescriptors& set, std::size_t k,
                      std::span<const BlockRange> ranges, std::span<std::uint32_t> out);

// The implementations, for tests and benchmarks.
void FindNearestTwoRef(const PackedQueries& queries, const PackedDescriptors& set, std::span<NearestTwo> out);
void FindNearestTwoSimd(const PackedQueries& queries, const PackedDescriptors& set, std::span<NearestTwo> out);
bool HasVnni();
/// Only where HasVnni().
void FindNearestTwoVnni(const PackedQueries& queries, const PackedDescriptors& set, std::span<NearestTwo> out);

void FindNearestKRef(const PackedQueries& queries, const PackedDescriptors& set, std::size_t k,
                     std::span<Neighbour> out);
void FindNearestKSimd(const PackedQueries& queries, const PackedDescriptors& set, std::size_t k,
                      std::span<Neighbour> out);
/// Only where HasVnni().
void FindNearestKVnni(const PackedQueries& queries, const PackedDescriptors& set, std::size_t k,
                      std::span<Neighbour> out);

void FindShortNearestRef(const PackedQueries& queries, const PackedDescriptors& set, std::size_t k,
                         std::span<const BlockRange> ranges, std::span<std::uint32_t> out);
void FindShortNearestSimd(const PackedQueries& queries, const PackedDescriptors& set, std::size_t k,
                          std::span<const BlockRange> ranges, std::span<std::uint32_t> out);
/// Only where HasVnni().
void FindShortNearestVnni(const PackedQueries& queries, const PackedDescriptors& set, std::size_t k,
                          std::span<const BlockRange> ranges, std::span<std::uint32_t> out);

}  // namespace victorious::kernels

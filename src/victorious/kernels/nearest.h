// kernels/, the hot loops of match/: for each query descriptor the nearest and second nearest of a set, or the k
// nearest, by squared Euclidean distance. Exhaustive and exact.
//
// The set is packed once into blocks (blocks.h): 16 lanes accumulate 16 distances without horizontal additions. With
// d = |q - b|^2 = |q|^2 + |b|^2 - 2 q.b the loop computes only q.b; all arithmetic is exact in 32 bits.
//
// nearest_ref.cc is the reference; nearest_simd.cc (Highway, every instruction set) and nearest_vnni.cc (x86-64 with
// AVX-512 VNNI) return identical bits. C++20: no <expected> here.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "victorious/kernels/blocks.h"
#include "victorious/kernels/descriptor.h"

namespace victorious::kernels {

inline constexpr std::size_t kBlockBytes = kBlockDescriptors * kDescriptorBytes;
inline constexpr std::uint32_t kNoDistance = 0xFFFFFFFF;

/// A packed set of descriptors. The last block is padded; padding is never returned.
struct PackedDescriptors {
  std::size_t count = 0;
  BlockVector<std::uint8_t> blocks;    ///< kBlockBytes a block
  BlockVector<std::int32_t> constant;  ///< per descriptor: |b|^2 - 256 sum(b); for padding: kPaddingDistance

  [[nodiscard]] std::size_t block_count() const { return constant.size() / kBlockDescriptors; }
};

/// @param rows  kDescriptorBytes per descriptor
PackedDescriptors Pack(std::span<const std::uint8_t> rows);

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
  std::vector<std::int8_t> rows;      ///< kDescriptorBytes per query: q - 128
  std::vector<std::int32_t> squared;  ///< |q|^2
};

/// @param rows  kDescriptorBytes per query
PackedQueries PackQueries(std::span<const std::uint8_t> rows);

/// Writes the result of query i to out[i]; out.size() == queries.count. Uses this machine's fastest implementation.
/// Cost: queries x set x 128 multiplications; AVX-512 VNNI does 64 per instruction.
void FindNearestTwo(const PackedQueries& queries, const PackedDescriptors& set, std::span<NearestTwo> out);

/// The name of the implementation that FindNearestTwo uses on this machine: "avx512_vnni", or Highway's target name.
const char* NearestTwoTargetName();

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

}  // namespace victorious::kernels

// The hot loops of matching: for each query descriptor, its nearest and second nearest of a set, or its few nearest, by
// squared distance.
//
// The set is packed once into blocks of 16 descriptors in which each 4 bytes of each descriptor lie together:
//   block[32 groups][16 descriptors][4 bytes]
// so that one load serves 16 descriptors, and the distances of 16 descriptors are summed in 16 lanes with no sideways
// additions. With d = |q - b|^2 = |q|^2 + |b|^2 - 2 q.b only q.b is left to the loop; everything is exact in 32 bits.
//
// nearest_ref.cc is the definition; nearest_simd.cc (Highway, every instruction set) and nearest_vnni.cc
// (x86-64 with AVX-512 VNNI) give the same bits. C++20: no <expected> here.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace victorious::kernels {

inline constexpr std::size_t kDescriptorBytes = 128;
inline constexpr std::size_t kBlockDescriptors = 16;
inline constexpr std::size_t kBlockBytes = kBlockDescriptors * kDescriptorBytes;
inline constexpr std::uint32_t kNoDistance = 0xFFFFFFFF;

/// A set of descriptors, packed. The last block is padded; padding is never found.
struct PackedDescriptors {
  std::size_t count = 0;
  std::vector<std::uint8_t> blocks;    ///< kBlockBytes a block (64-byte alignment is not needed: loads are unaligned)
  std::vector<std::int32_t> constant;  ///< a descriptor: |b|^2 - 256 sum(b); for padding: a value that is never least

  [[nodiscard]] std::size_t block_count() const { return constant.size() / kBlockDescriptors; }
};

/// @param rows  128 bytes a descriptor
PackedDescriptors Pack(std::span<const std::uint8_t> rows);

/// What is nearest to one query.
struct NearestTwo {
  std::uint32_t best_index = 0;                  ///< of the smallest distance; the lowest index where several are equal
  std::uint32_t best_distance2 = kNoDistance;    ///< squared; kNoDistance for an empty set
  std::uint32_t second_distance2 = kNoDistance;  ///< squared, of another descriptor; kNoDistance for a set of one

  bool operator==(const NearestTwo&) const = default;
};

/// Queries made ready once and searched in many sets.
struct PackedQueries {
  std::size_t count = 0;
  std::vector<std::int8_t> rows;      ///< 128 bytes a query: q - 128
  std::vector<std::int32_t> squared;  ///< |q|^2
};

/// @param rows  128 bytes a query
PackedQueries PackQueries(std::span<const std::uint8_t> rows);

/// out[i] is the answer for query i; out.size() == queries.count. Uses the best implementation of this machine.
/// Cost: queries x set x 128 multiplications; on AVX-512 VNNI 64 of them an instruction.
void FindNearestTwo(const PackedQueries& queries, const PackedDescriptors& set, std::span<NearestTwo> out);

/// The implementation that FindNearestTwo uses here: "avx512_vnni", or Highway's name of its target.
const char* NearestTwoTarget();

/// One of the few nearest to a query.
struct Neighbour {
  std::uint32_t index = 0;
  std::uint32_t distance2 = kNoDistance;  ///< squared; kNoDistance where the set has fewer descriptors

  bool operator==(const Neighbour&) const = default;
};

inline constexpr std::size_t kMostNeighbours = 8;

/// The `few` nearest to each query: out[few i] to out[few i + few - 1] for query i, nearest first, of equal distances
/// the lower index first. 1 <= few <= kMostNeighbours; out.size() == few * queries.count. Cost: that of FindNearestTwo.
void FindNearestFew(const PackedQueries& queries, const PackedDescriptors& set, std::size_t few,
                    std::span<Neighbour> out);

// The implementations, for tests and benchmarks.
void FindNearestTwoRef(const PackedQueries& queries, const PackedDescriptors& set, std::span<NearestTwo> out);
void FindNearestTwoSimd(const PackedQueries& queries, const PackedDescriptors& set, std::span<NearestTwo> out);
bool HasVnni();
/// Only where HasVnni().
void FindNearestTwoVnni(const PackedQueries& queries, const PackedDescriptors& set, std::span<NearestTwo> out);

void FindNearestFewRef(const PackedQueries& queries, const PackedDescriptors& set, std::size_t few,
                       std::span<Neighbour> out);
void FindNearestFewSimd(const PackedQueries& queries, const PackedDescriptors& set, std::size_t few,
                        std::span<Neighbour> out);
/// Only where HasVnni().
void FindNearestFewVnni(const PackedQueries& queries, const PackedDescriptors& set, std::size_t few,
                        std::span<Neighbour> out);

}  // namespace victorious::kernels

// kernels/, the first pass of a proposal search (search/match/upright_matcher.h): about the k nearest of shortened
// descriptors (shorten.h), each query in one or two ranges of a set.
//
// The set is packed into blocks (blocks.h). Values have 7 bits and queries are centred, so that four products fit in 16
// bits. Two descriptors are compared by half their squared distance, rounded down, without |q|^2, which is common to
// all distances of a query:
//   floor(|b|^2 / 2) - q.b
// A key is this half distance and the number of the descriptor: of two keys, the smaller one is the nearer, of equal
// distances the lower number. The loop has no branches: of each lane (number modulo 16) only the two nearest are kept;
// of the nearest four of a hundred random ones 99 % are among them.
//
// short_nearest_ref.cc is the reference; short_nearest_simd.cc (Highway, every instruction set) and
// short_nearest_vnni.cc (x86-64 with AVX-512 VNNI) return identical bits. C++20: no <expected> here.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "victorious/kernels/blocks.h"
#include "victorious/kernels/shorten.h"

namespace victorious::kernels {

inline constexpr int kShortIndexBits = 12;  ///< of a key
/// Largest set that FindShortNearest searches.
inline constexpr std::size_t kMaxShortSet = std::size_t{1} << kShortIndexBits;
inline constexpr std::size_t kMaxShortNeighbours = 8;
inline constexpr std::uint32_t kNoNeighbour = 0xFFFFFFFF;

/// A packed set of shortened descriptors. The last block is padded; padding is never nearest.
struct ShortSet {
  std::size_t count = 0;
  BlockVector<std::uint8_t> blocks;
  BlockVector<std::int32_t> half_constant;  ///< per descriptor: floor(|b|^2 / 2) - 64 sum(b)

  [[nodiscard]] std::size_t block_count() const { return half_constant.size() / kBlockDescriptors; }
};

/// @param rows  of Shorten()
ShortSet PackShort(std::span<const std::uint8_t> rows);

/// Some descriptors of a set, in this order.
/// @param numbers  of descriptors, below set.count
ShortSet SelectShort(const ShortSet& set, std::span<const std::uint32_t> numbers);

/// The blocks [first, last) of a set.
struct BlockRange {
  std::size_t first = 0;
  std::size_t last = 0;
};

/// The blocks that one query is compared with: two ranges without common blocks.
struct QueryBlocks {
  BlockRange low;
  BlockRange high;
};

/// For each query i the numbers of about the k nearest descriptors of its blocks, in out[k i] to out[k i + k - 1]:
/// nearest first, of equal distances the lower number first, kNoNeighbour if there are fewer.
/// 1 <= k <= kMaxShortNeighbours; set.count <= kMaxShortSet; the ranges lie inside the set.
/// @param queries  rows of ShortenToQueries()
/// @param blocks   of each query
/// Cost: 32 8-bit products for each descriptor of the ranges.
void FindShortNearest(std::span<const std::int8_t* const> queries, const ShortSet& set, std::size_t k,
                      std::span<const QueryBlocks> blocks, std::span<std::uint32_t> out);

/// The half distances of all descriptors of a set, of any size, to one query; padding has the largest.
/// @param query  a row of ShortenToQueries()
/// @param out    set.half_constant.size() values
void ComputeHalfDistances(std::span<const std::int8_t> query, const ShortSet& set, std::span<std::int32_t> out);

/// Half distance of padding: the largest of a key.
inline constexpr std::int32_t kShortPadding = std::numeric_limits<std::int32_t>::max() >> kShortIndexBits;

// The implementations, for tests and benchmarks.
void FindShortNearestRef(std::span<const std::int8_t* const> queries, const ShortSet& set, std::size_t k,
                         std::span<const QueryBlocks> blocks, std::span<std::uint32_t> out);
void FindShortNearestSimd(std::span<const std::int8_t* const> queries, const ShortSet& set, std::size_t k,
                          std::span<const QueryBlocks> blocks, std::span<std::uint32_t> out);
/// Only where HasVnni() (nearest.h).
void FindShortNearestVnni(std::span<const std::int8_t* const> queries, const ShortSet& set, std::size_t k,
                          std::span<const QueryBlocks> blocks, std::span<std::uint32_t> out);

void ComputeHalfDistancesRef(std::span<const std::int8_t> query, const ShortSet& set, std::span<std::int32_t> out);
void ComputeHalfDistancesSimd(std::span<const std::int8_t> query, const ShortSet& set, std::span<std::int32_t> out);

}  // namespace victorious::kernels

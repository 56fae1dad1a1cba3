// FindNearestTwo and FindNearestK with the 8-bit dot product of AVX-512 VNNI, which Debian's Highway
// lacks: 64 products per instruction.
#include "victorious/base/check.h"
#include "victorious/kernels/k_nearest.h"
#include "victorious/kernels/nearest.h"
#include "victorious/kernels/reduce_nearest_two.h"

#if defined(__x86_64__)

#include <algorithm>
#include <bit>
#include <cstring>
#include <vector>

// GCC 12 reports false positives for the undefined registers inside the intrinsics.
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#include <immintrin.h>

namespace victorious::kernels {
namespace {

#define VICTORIOUS_VNNI __attribute__((target("avx512f,avx512bw,avx512vnni")))

constexpr std::size_t kTile = 8;  // queries at a time: with two blocks 16 of the 32 registers are sums

// _mm512_dpbusd_epi32(sum, bytes, words) in place: GCC 12 copies the sum before and after each.
VICTORIOUS_VNNI inline void AddProducts(__m512i& sum, __m512i bytes, __m512i words) {
  asm("vpdpbusd %2, %1, %0" : "+v"(sum) : "v"(bytes), "v"(words));
}

// Of the descriptors of `count` blocks that follow each other: |b|^2 - 256 sum(b) - 2 q.b for each query. With two
// blocks each word of a query is loaded once for both, and 16 sums hide the latency of a product. Not inlined, and all
// loops over the sums unrolled: else GCC would keep some of them in memory.
template <std::size_t count>
[[gnu::noinline]] VICTORIOUS_VNNI void ComputeDistances(const PackedDescriptors& set, std::size_t block,
                                                        const std::int8_t* const (&rows)[kTile],
                                                        std::int32_t (&distances)[count][kTile][kBlockDescriptors]) {
  const std::uint8_t* const bytes = set.blocks.data() + block * kBlockBytes;
  __m512i sums[count][kTile];
#pragma GCC unroll 2
  for (std::size_t b = 0; b < count; ++b) {
#pragma GCC unroll 8
    for (std::size_t t = 0; t < kTile; ++t) sums[b][t] = _mm512_setzero_si512();
  }
  for (std::size_t g = 0; g < kDescriptorBytes / 4; ++g) {
    __m512i of_block[count];
#pragma GCC unroll 2
    for (std::size_t b = 0; b < count; ++b) {
      of_block[b] = _mm512_loadu_si512(bytes + b * kBlockBytes + g * 4 * kBlockDescriptors);
    }
#pragma GCC unroll 8
    for (std::size_t t = 0; t < kTile; ++t) {
      int word;
      std::memcpy(&word, rows[t] + g * 4, 4);
      const __m512i words = _mm512_set1_epi32(word);
#pragma GCC unroll 2
      for (std::size_t b = 0; b < count; ++b) AddProducts(sums[b][t], of_block[b], words);
    }
  }
#pragma GCC unroll 2
  for (std::size_t b = 0; b < count; ++b) {
    const __m512i constant = _mm512_loadu_si512(set.constant.data() + (block + b) * kBlockDescriptors);
#pragma GCC unroll 8
    for (std::size_t t = 0; t < kTile; ++t) {
      _mm512_store_si512(distances[b][t], _mm512_sub_epi32(constant, _mm512_slli_epi32(sums[b][t], 1)));
    }
  }
}

// Calls use(distances of the block's descriptors, block) for each block of a set, in their order.
template <typename Use>
VICTORIOUS_VNNI inline void ForEachBlock(const PackedDescriptors& set, const std::int8_t* const (&rows)[kTile],
                                         const Use& use) {
  alignas(64) std::int32_t of_two[2][kTile][kBlockDescriptors];
  alignas(64) std::int32_t of_last[1][kTile][kBlockDescriptors];
  std::size_t block = 0;
  for (; block + 1 < set.block_count(); block += 2) {
    ComputeDistances(set, block, rows, of_two);
    use(of_two[0], block);
    use(of_two[1], block + 1);
  }
  if (block == set.block_count()) return;
  ComputeDistances(set, block, rows, of_last);
  use(of_last[0], block);
}

// Inserts the descriptors of a block that are nearer than the worst of a query so far.
VICTORIOUS_VNNI inline void InsertNearer(const std::int32_t (&distances)[kTile][kBlockDescriptors], std::size_t block,
                                         std::vector<KNearest>& found) {
  for (std::size_t t = 0; t < kTile; ++t) {
    unsigned nearer = _mm512_cmplt_epi32_mask(_mm512_load_si512(distances[t]), _mm512_set1_epi32(found[t].Worst()));
    for (; nearer != 0; nearer &= nearer - 1) {  // none is the common case after the first blocks
      const auto lane = static_cast<std::size_t>(std::countr_zero(nearer));
      found[t].Insert(distances[t][lane], static_cast<std::uint32_t>(block * kBlockDescriptors + lane));
    }
  }
}

// The two nearest of each query by lane, and the block of the nearest.
struct TwoByLane {
  __m512i best[kTile];
  __m512i second[kTile];
  __m512i best_block[kTile];
};

VICTORIOUS_VNNI inline void KeepTwo(const std::int32_t (&distances)[kTile][kBlockDescriptors], std::size_t block,
                                    TwoByLane& two) {
  const __m512i number = _mm512_set1_epi32(static_cast<int>(block));
  for (std::size_t t = 0; t < kTile; ++t) {
    const __m512i distance = _mm512_load_si512(distances[t]);
    const __mmask16 nearer = _mm512_cmplt_epi32_mask(distance, two.best[t]);
    two.second[t] = _mm512_min_epi32(two.second[t], _mm512_max_epi32(two.best[t], distance));
    two.best[t] = _mm512_min_epi32(two.best[t], distance);
    two.best_block[t] = _mm512_mask_mov_epi32(two.best_block[t], nearer, number);
  }
}

// The last tile repeats its last query.
void TileRows(const PackedQueries& queries, std::size_t first, const std::int8_t* (&rows)[kTile]) {
  for (std::size_t t = 0; t < kTile; ++t) {
    rows[t] = queries.rows.data() + std::min(first + t, queries.count - 1) * kDescriptorBytes;
  }
}

}  // namespace

bool HasVnni() {
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
         __builtin_cpu_supports("avx512vnni");
}

VICTORIOUS_VNNI void FindNearestTwoVnni(const PackedQueries& queries, const PackedDescriptors& set,
                                        std::span<NearestTwo> out) {
  for (std::size_t first = 0; first < queries.count; first += kTile) {
    const std::size_t tile = std::min(kTile, queries.count - first);
    const std::int8_t* rows[kTile];
    TileRows(queries, first, rows);
    TwoByLane two;
    for (std::size_t t = 0; t < kTile; ++t) {
      two.best[t] = two.second[t] = _mm512_set1_epi32(1 << 30);
      two.best_block[t] = _mm512_setzero_si512();
    }
    ForEachBlock(set, rows,
                 [&](const std::int32_t(&distances)[kTile][kBlockDescriptors], std::size_t block)
                     VICTORIOUS_VNNI { KeepTwo(distances, block, two); });
    for (std::size_t t = 0; t < tile; ++t) {
      LaneResults lanes;
      _mm512_store_si512(lanes.best, two.best[t]);
      _mm512_store_si512(lanes.second, two.second[t]);
      _mm512_store_si512(lanes.block, two.best_block[t]);
      out[first + t] = ReduceLanes(lanes, queries.squared[first + t], set.count);
    }
  }
}

VICTORIOUS_VNNI void FindNearestKVnni(const PackedQueries& queries, const PackedDescriptors& set, std::size_t k,
                                      std::span<Neighbour> out) {
  for (std::size_t first = 0; first < queries.count; first += kTile) {
    const std::int8_t* rows[kTile];
    TileRows(queries, first, rows);
    std::vector<KNearest> found(kTile, KNearest(k));
    ForEachBlock(set, rows,
                 [&](const std::int32_t(&distances)[kTile][kBlockDescriptors], std::size_t block)
                     VICTORIOUS_VNNI { InsertNearer(distances, block, found); });
    const std::size_t tile = std::min(kTile, queries.count - first);
    for (std::size_t t = 0; t < tile; ++t) found[t].Write(queries.squared[first + t], &out[(first + t) * k]);
  }
}

}  // namespace victorious::kernels

#else

namespace victorious::kernels {

bool HasVnni() { return false; }
void FindNearestTwoVnni(const PackedQueries&, const PackedDescriptors&, std::span<NearestTwo>) {
  VICTORIOUS_CHECK(HasVnni());
}
void FindNearestKVnni(const PackedQueries&, const PackedDescriptors&, std::size_t, std::span<Neighbour>) {
  VICTORIOUS_CHECK(HasVnni());
}

}  // namespace victorious::kernels

#endif

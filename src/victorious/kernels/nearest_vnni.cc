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

constexpr std::size_t kTile = 8;  // queries per tile: 8 sums and 24 running results fill the 32 registers

// The 8 partial products q.b of one block's 16 descriptors with 8 queries. GCC keeps the array in registers.
VICTORIOUS_VNNI inline void DotBlock(const std::uint8_t* block, const std::int8_t* const (&rows)[kTile],
                                     __m512i (&sums)[kTile]) {
  for (__m512i& sum : sums) sum = _mm512_setzero_si512();
  for (std::size_t g = 0; g < kDescriptorBytes / 4; ++g) {
    const __m512i bytes = _mm512_loadu_si512(block + g * 4 * kBlockDescriptors);
    for (std::size_t t = 0; t < kTile; ++t) {
      int word;
      std::memcpy(&word, rows[t] + g * 4, 4);
      sums[t] = _mm512_dpbusd_epi32(sums[t], bytes, _mm512_set1_epi32(word));
    }
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
  const std::size_t blocks = set.block_count();
  for (std::size_t first = 0; first < queries.count; first += kTile) {
    const std::size_t tile = std::min(kTile, queries.count - first);
    const std::int8_t* rows[kTile];
    TileRows(queries, first, rows);
    __m512i best[kTile];
    __m512i second[kTile];
    __m512i best_block[kTile];
    for (std::size_t t = 0; t < kTile; ++t) {
      best[t] = second[t] = _mm512_set1_epi32(1 << 30);
      best_block[t] = _mm512_setzero_si512();
    }
    for (std::size_t block = 0; block < blocks; ++block) {
      __m512i sums[kTile];
      DotBlock(set.blocks.data() + block * kBlockBytes, rows, sums);
      const __m512i constant = _mm512_loadu_si512(set.constant.data() + block * kBlockDescriptors);
      const __m512i number = _mm512_set1_epi32(static_cast<int>(block));
      for (std::size_t t = 0; t < kTile; ++t) {
        const __m512i distance = _mm512_sub_epi32(constant, _mm512_slli_epi32(sums[t], 1));
        const __mmask16 nearer = _mm512_cmplt_epi32_mask(distance, best[t]);
        second[t] = _mm512_min_epi32(second[t], _mm512_max_epi32(best[t], distance));
        best[t] = _mm512_min_epi32(best[t], distance);
        best_block[t] = _mm512_mask_mov_epi32(best_block[t], nearer, number);
      }
    }
    for (std::size_t t = 0; t < tile; ++t) {
      LaneResults lanes;
      _mm512_store_si512(lanes.best, best[t]);
      _mm512_store_si512(lanes.second, second[t]);
      _mm512_store_si512(lanes.block, best_block[t]);
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
    __m512i worst[kTile];
    for (__m512i& one : worst) one = _mm512_set1_epi32(kPaddingDistance);
    for (std::size_t block = 0; block < set.block_count(); ++block) {
      __m512i sums[kTile];
      DotBlock(set.blocks.data() + block * kBlockBytes, rows, sums);
      const __m512i constant = _mm512_loadu_si512(set.constant.data() + block * kBlockDescriptors);
      for (std::size_t t = 0; t < kTile; ++t) {
        const __m512i distance = _mm512_sub_epi32(constant, _mm512_slli_epi32(sums[t], 1));
        unsigned nearer = _mm512_cmplt_epi32_mask(distance, worst[t]);
        if (nearer == 0) continue;  // the common case after the first blocks
        alignas(64) std::int32_t distances[kBlockDescriptors];
        _mm512_store_si512(distances, distance);
        for (; nearer != 0; nearer &= nearer - 1) {
          const std::size_t lane = static_cast<std::size_t>(std::countr_zero(nearer));
          found[t].Insert(distances[lane], static_cast<std::uint32_t>(block * kBlockDescriptors + lane));
        }
        worst[t] = _mm512_set1_epi32(found[t].Worst());
      }
    }
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

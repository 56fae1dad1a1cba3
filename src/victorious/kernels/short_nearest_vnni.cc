// FindShortNearest with the 8-bit dot product of AVX-512 VNNI, which Debian's Highway lacks: 64 products per
// instruction.
#include "victorious/base/check.h"
#include "victorious/kernels/nearest.h"
#include "victorious/kernels/short_nearest.h"

#if defined(__x86_64__)

#include <algorithm>
#include <cstring>
#include <limits>

// GCC 12 reports false positives for the undefined registers inside the intrinsics.
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#include <immintrin.h>

namespace victorious::kernels {
namespace {

#define VICTORIOUS_VNNI __attribute__((target("avx512f,avx512bw,avx512vnni")))

constexpr std::size_t kGroups = kShortBytes / 4;
constexpr std::int32_t kNoKey = std::numeric_limits<std::int32_t>::max();
// Queries whose keys are found before the smallest of each are chosen: a choice waits for the one before it, so that
// those of several queries are made at the same time.
constexpr std::size_t kBatch = 8;

// The products of one block's 16 descriptors with a query. GCC keeps the array in registers.
VICTORIOUS_VNNI inline __m512i DotBlock(const std::uint8_t* block, const __m512i (&query)[kGroups]) {
  __m512i even = _mm512_setzero_si512();
  __m512i odd = even;
  for (std::size_t g = 0; g < kGroups; g += 2) {
    even = _mm512_dpbusd_epi32(even, _mm512_loadu_si512(block + g * 4 * kBlockDescriptors), query[g]);
    odd = _mm512_dpbusd_epi32(odd, _mm512_loadu_si512(block + (g + 1) * 4 * kBlockDescriptors), query[g + 1]);
  }
  return _mm512_add_epi32(even, odd);
}

// The keys of the two nearest by lane.
struct NearestByLane {
  __m512i best;
  __m512i second;
};

VICTORIOUS_VNNI inline NearestByLane FindByLane(const std::int8_t* row, const ShortSet& set,
                                                const QueryBlocks& blocks) {
  const __m512i lanes = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  __m512i query[kGroups];
  for (std::size_t g = 0; g < kGroups; ++g) {
    int word;
    std::memcpy(&word, row + g * 4, 4);
    query[g] = _mm512_set1_epi32(word);
  }
  NearestByLane found = {_mm512_set1_epi32(kNoKey), _mm512_set1_epi32(kNoKey)};
  for (const BlockRange& range : {blocks.low, blocks.high}) {
    for (std::size_t block = range.first; block < range.last; ++block) {
      const __m512i product = DotBlock(set.blocks.data() + block * kBlockDescriptors * kShortBytes, query);
      const __m512i half_constant = _mm512_loadu_si512(set.half_constant.data() + block * kBlockDescriptors);
      const __m512i number = _mm512_add_epi32(lanes, _mm512_set1_epi32(static_cast<int>(block * kBlockDescriptors)));
      const __m512i key =
          _mm512_add_epi32(_mm512_slli_epi32(_mm512_sub_epi32(half_constant, product), kShortIndexBits), number);
      found.second = _mm512_min_epi32(found.second, _mm512_max_epi32(found.best, key));
      found.best = _mm512_min_epi32(found.best, key);
    }
  }
  return found;
}

// Writes the k smallest of the 32 keys, which are unique.
VICTORIOUS_VNNI inline void WriteNearest(NearestByLane found, std::size_t k, std::uint32_t* out) {
  for (std::size_t r = 0; r < k; ++r) {
    const std::int32_t key = _mm512_reduce_min_epi32(found.best);
    out[r] =
        key >> kShortIndexBits == kShortPadding ? kNoNeighbour : static_cast<std::uint32_t>(key) & (kMaxShortSet - 1);
    const __mmask16 is_it = _mm512_cmpeq_epi32_mask(found.best, _mm512_set1_epi32(key));
    found.best = _mm512_mask_mov_epi32(found.best, is_it, found.second);
    found.second = _mm512_mask_mov_epi32(found.second, is_it, _mm512_set1_epi32(kNoKey));
  }
}

}  // namespace

VICTORIOUS_VNNI void FindShortNearestVnni(std::span<const std::int8_t* const> queries, const ShortSet& set,
                                          std::size_t k, std::span<const QueryBlocks> blocks,
                                          std::span<std::uint32_t> out) {
  NearestByLane found[kBatch];
  for (std::size_t first = 0; first < queries.size(); first += kBatch) {
    const std::size_t count = std::min(kBatch, queries.size() - first);
    for (std::size_t i = 0; i < count; ++i) found[i] = FindByLane(queries[first + i], set, blocks[first + i]);
    for (std::size_t i = 0; i < count; ++i) WriteNearest(found[i], k, &out[(first + i) * k]);
  }
}

}  // namespace victorious::kernels

#else

namespace victorious::kernels {

void FindShortNearestVnni(std::span<const std::int8_t* const>, const ShortSet&, std::size_t,
                          std::span<const QueryBlocks>, std::span<std::uint32_t>) {
  VICTORIOUS_CHECK(HasVnni());
}

}  // namespace victorious::kernels

#endif

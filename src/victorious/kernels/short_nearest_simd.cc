// FindShortNearest and ComputeHalfDistances on any vector width, through Highway: compiled once for each instruction
// set, chosen at run time.
#include <cstring>

#include "victorious/kernels/no_sve.h"
#include "victorious/kernels/short_nearest.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "victorious/kernels/short_nearest_simd.cc"
#include <hwy/foreach_target.h>
// Highway requires this order: after foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace victorious::kernels::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// At most 16 lanes of 32 bits: one lane a descriptor of the block.
using D32 = hn::CappedTag<std::int32_t, kBlockDescriptors>;
using V32 = hn::Vec<D32>;

constexpr std::size_t kGroups = kShortBytes / 4;
constexpr std::size_t kLanes = hn::MaxLanes(D32());
constexpr std::size_t kVectors = kBlockDescriptors / kLanes;  // of a block

#if HWY_TARGET == HWY_SSSE3 || HWY_TARGET == HWY_SSE4 || HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3 || \
    HWY_TARGET == HWY_AVX3_DL
// The sums of neighbouring products of unsigned and signed bytes, which Debian's Highway lacks.
#if HWY_TARGET == HWY_SSSE3 || HWY_TARGET == HWY_SSE4
HWY_INLINE V32 MultiplyPairs(V32 unsigned_bytes, V32 bytes) {
  return V32{_mm_maddubs_epi16(unsigned_bytes.raw, bytes.raw)};
}
#elif HWY_TARGET == HWY_AVX2
HWY_INLINE V32 MultiplyPairs(V32 unsigned_bytes, V32 bytes) {
  return V32{_mm256_maddubs_epi16(unsigned_bytes.raw, bytes.raw)};
}
#else
HWY_INLINE V32 MultiplyPairs(V32 unsigned_bytes, V32 bytes) {
  return V32{_mm512_maddubs_epi16(unsigned_bytes.raw, bytes.raw)};
}
#endif

// The products of 8 bytes, lane by lane: two pairs of products of 7-bit values and of 6 bits with sign fit in 16 bits.
HWY_INLINE V32 Dot8(V32 set0, V32 query0, V32 set1, V32 query1) {
  const D32 d32;
  const hn::Repartition<std::int16_t, D32> d16;
  const auto pairs =
      hn::Add(hn::BitCast(d16, MultiplyPairs(set0, query0)), hn::BitCast(d16, MultiplyPairs(set1, query1)));
  V32 unused = hn::Zero(d32);
  return hn::ReorderWidenMulAccumulate(d32, pairs, hn::Set(d16, 1), hn::Zero(d32), unused);
}
#else
HWY_INLINE V32 Dot4(V32 set, V32 query) {
  const D32 d32;
  const V32 mask = hn::Set(d32, 0xFF);
  V32 sum = hn::Mul(hn::And(set, mask), hn::ShiftRight<24>(hn::ShiftLeft<24>(query)));
  sum = hn::Add(sum, hn::Mul(hn::And(hn::ShiftRight<8>(set), mask), hn::ShiftRight<24>(hn::ShiftLeft<16>(query))));
  sum = hn::Add(sum, hn::Mul(hn::And(hn::ShiftRight<16>(set), mask), hn::ShiftRight<24>(hn::ShiftLeft<8>(query))));
  return hn::Add(sum, hn::Mul(hn::And(hn::ShiftRight<24>(set), mask), hn::ShiftRight<24>(query)));
}

HWY_INLINE V32 Dot8(V32 set0, V32 query0, V32 set1, V32 query1) {
  return hn::Add(Dot4(set0, query0), Dot4(set1, query1));
}
#endif

// A query, each group of 4 bytes in all lanes.
struct Query {
  V32 group0, group1, group2, group3, group4, group5, group6, group7;
};

HWY_INLINE Query LoadQuery(const std::int8_t* row) {
  std::int32_t words[kGroups];
  std::memcpy(words, row, sizeof(words));
  const D32 d32;
  return {hn::Set(d32, words[0]), hn::Set(d32, words[1]), hn::Set(d32, words[2]), hn::Set(d32, words[3]),
          hn::Set(d32, words[4]), hn::Set(d32, words[5]), hn::Set(d32, words[6]), hn::Set(d32, words[7])};
}

// The products with the lanes of a block from `bytes` on.
HWY_INLINE V32 Dot(const Query& query, const std::uint8_t* bytes) {
  const D32 d32;
  const auto load = [&](std::size_t group) HWY_ATTR {
    return hn::LoadU(d32, reinterpret_cast<const std::int32_t*>(bytes + group * 4 * kBlockDescriptors));
  };
  const V32 low =
      hn::Add(Dot8(load(0), query.group0, load(1), query.group1), Dot8(load(2), query.group2, load(3), query.group3));
  const V32 high =
      hn::Add(Dot8(load(4), query.group4, load(5), query.group5), Dot8(load(6), query.group6, load(7), query.group7));
  return hn::Add(low, high);
}

// The two smallest keys of each lane.
struct LaneKeys {
  alignas(64) std::int32_t best[kBlockDescriptors];
  alignas(64) std::int32_t second[kBlockDescriptors];
};

constexpr std::int32_t kNoKey = std::numeric_limits<std::int32_t>::max();

HWY_INLINE void SearchLanes(const Query& query, const ShortSet& set, const QueryBlocks& blocks, std::size_t lane,
                            LaneKeys& keys) {
  const D32 d32;
  V32 best = hn::Set(d32, kNoKey);
  V32 second = best;
  const V32 lanes = hn::Iota(d32, static_cast<std::int32_t>(lane));
  for (const BlockRange& range : {blocks.low, blocks.high}) {
    for (std::size_t block = range.first; block < range.last; ++block) {
      const V32 product = Dot(query, set.blocks.data() + block * kBlockDescriptors * kShortBytes + lane * 4);
      const V32 half_constant = hn::LoadU(d32, set.half_constant.data() + block * kBlockDescriptors + lane);
      const V32 number = hn::Add(lanes, hn::Set(d32, static_cast<std::int32_t>(block * kBlockDescriptors)));
      const V32 key = hn::Add(hn::ShiftLeft<kShortIndexBits>(hn::Sub(half_constant, product)), number);
      second = hn::Min(second, hn::Max(best, key));
      best = hn::Min(best, key);
    }
  }
  hn::Store(best, d32, keys.best + lane);
  hn::Store(second, d32, keys.second + lane);
}

// Writes the numbers of the k smallest keys. Keys are unique, but for those that are none.
HWY_INLINE void WriteNearest(const LaneKeys& keys, std::size_t k, std::uint32_t* out) {
  const D32 d32;
  V32 best[kVectors];
  V32 second[kVectors];
  for (std::size_t v = 0; v < kVectors; ++v) {
    best[v] = hn::Load(d32, keys.best + v * kLanes);
    second[v] = hn::Load(d32, keys.second + v * kLanes);
  }
  for (std::size_t r = 0; r < k; ++r) {
    V32 smallest = best[0];
    for (std::size_t v = 1; v < kVectors; ++v) smallest = hn::Min(smallest, best[v]);
    smallest = hn::MinOfLanes(d32, smallest);
    const std::int32_t key = hn::GetLane(smallest);
    out[r] =
        key >> kShortIndexBits == kShortPadding ? kNoNeighbour : static_cast<std::uint32_t>(key) & (kMaxShortSet - 1);
    for (std::size_t v = 0; v < kVectors; ++v) {
      const auto is_it = hn::Eq(best[v], smallest);
      best[v] = hn::IfThenElse(is_it, second[v], best[v]);
      second[v] = hn::IfThenElse(is_it, hn::Set(d32, kNoKey), second[v]);
    }
  }
}

// Queries are anywhere in memory, and each begins in another block: both are fetched one query ahead.
void PrefetchQuery(const std::int8_t* row, const ShortSet& set, const QueryBlocks& blocks) {
  constexpr std::size_t kCacheLine = 64;
  constexpr std::size_t kFetchedBytes = 2 * kBlockDescriptors * kShortBytes;  // the processor fetches what follows
  __builtin_prefetch(row);
  const std::uint8_t* const bytes = set.blocks.data() + blocks.low.first * kBlockDescriptors * kShortBytes;
  for (std::size_t i = 0; i < kFetchedBytes; i += kCacheLine) __builtin_prefetch(bytes + i);
}

void FindShortNearestTarget(std::span<const std::int8_t* const> queries, const ShortSet& set, std::size_t k,
                            std::span<const QueryBlocks> blocks, std::span<std::uint32_t> out) {
  for (std::size_t q = 0; q < queries.size(); ++q) {
    const Query query = LoadQuery(queries[q]);
    if (q + 1 < queries.size()) PrefetchQuery(queries[q + 1], set, blocks[q + 1]);
    LaneKeys keys;
    for (std::size_t v = 0; v < kVectors; ++v) SearchLanes(query, set, blocks[q], v * kLanes, keys);
    WriteNearest(keys, k, &out[q * k]);
  }
}

void ComputeHalfDistancesTarget(std::span<const std::int8_t> query, const ShortSet& set, std::span<std::int32_t> out) {
  const D32 d32;
  const Query loaded = LoadQuery(query.data());
  for (std::size_t i = 0; i < out.size(); i += kLanes) {
    const std::size_t block = i / kBlockDescriptors;
    const V32 product =
        Dot(loaded, set.blocks.data() + block * kBlockDescriptors * kShortBytes + i % kBlockDescriptors * 4);
    hn::StoreU(hn::Sub(hn::LoadU(d32, set.half_constant.data() + i), product), d32, out.data() + i);
  }
}

}  // namespace victorious::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace victorious::kernels {

HWY_EXPORT(FindShortNearestTarget);
HWY_EXPORT(ComputeHalfDistancesTarget);

void FindShortNearestSimd(std::span<const std::int8_t* const> queries, const ShortSet& set, std::size_t k,
                          std::span<const QueryBlocks> blocks, std::span<std::uint32_t> out) {
  HWY_DYNAMIC_DISPATCH(FindShortNearestTarget)(queries, set, k, blocks, out);
}

void ComputeHalfDistancesSimd(std::span<const std::int8_t> query, const ShortSet& set, std::span<std::int32_t> out) {
  HWY_DYNAMIC_DISPATCH(ComputeHalfDistancesTarget)(query, set, out);
}

}  // namespace victorious::kernels
#endif  // HWY_ONCE

// FindNearestTwo and FindNearestK on any vector width, through Highway: compiled once for each
// instruction set, chosen at run time.
#include <algorithm>
#include <vector>

#include "victorious/kernels/k_nearest.h"
#include "victorious/kernels/nearest.h"
#include "victorious/kernels/no_sve.h"
#include "victorious/kernels/reduce_nearest_two.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "victorious/kernels/nearest_simd.cc"
#include <hwy/foreach_target.h>
// Highway requires this order: after foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace victorious::kernels::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// At most 16 lanes of 32 bits: one lane a descriptor of the block.
using D32 = hn::CappedTag<std::int32_t, kBlockDescriptors>;
using V32 = hn::Vec<D32>;

// 4 bytes of a query, widened to 16 bits: bytes 0 and 2 in one word, 1 and 3 in the other.
struct QueryGroup {
  std::int32_t even;
  std::int32_t odd;
};

QueryGroup Widen(const std::int8_t* bytes) {
  const auto word = [](std::int8_t low, std::int8_t high) {
    const auto bits = [](std::int8_t byte) { return static_cast<std::uint32_t>(static_cast<std::uint16_t>(byte)); };
    return static_cast<std::int32_t>(bits(low) | (bits(high) << 16));
  };
  return {word(bytes[0], bytes[2]), word(bytes[1], bytes[3])};
}

#if HWY_TARGET == HWY_SSSE3 || HWY_TARGET == HWY_SSE4 || HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3 || \
    HWY_TARGET == HWY_AVX3_DL
// sum += the 4 products, lane by lane. On x86 ReorderWidenMulAccumulate is pmaddwd: neighbouring 16-bit products are
// summed into the 32-bit lane that holds them, as needed here.
HWY_INLINE V32 AddDot4(V32 set_bytes, const QueryGroup& query, V32 sum) {
  const D32 d32;
  const hn::Repartition<std::int16_t, D32> d16;
  const hn::Repartition<std::uint16_t, D32> du16;
  const auto bytes = hn::BitCast(du16, set_bytes);
  const auto even = hn::BitCast(d16, hn::And(bytes, hn::Set(du16, 0x00FF)));
  const auto odd = hn::BitCast(d16, hn::ShiftRight<8>(bytes));
  V32 unused = hn::Zero(d32);
  sum = hn::ReorderWidenMulAccumulate(d32, even, hn::BitCast(d16, hn::Set(d32, query.even)), sum, unused);
  return hn::ReorderWidenMulAccumulate(d32, odd, hn::BitCast(d16, hn::Set(d32, query.odd)), sum, unused);
}
#else
HWY_INLINE V32 AddDot4(V32 set_bytes, const QueryGroup& query, V32 sum) {
  const D32 d32;
  const auto low = [&](std::int32_t word) { return hn::Set(d32, static_cast<std::int16_t>(word & 0xFFFF)); };
  const auto high = [&](std::int32_t word) { return hn::Set(d32, word >> 16); };
  const V32 mask = hn::Set(d32, 0xFF);
  sum = hn::Add(sum, hn::Mul(hn::And(set_bytes, mask), low(query.even)));
  sum = hn::Add(sum, hn::Mul(hn::And(hn::ShiftRight<8>(set_bytes), mask), low(query.odd)));
  sum = hn::Add(sum, hn::Mul(hn::And(hn::ShiftRight<16>(set_bytes), mask), high(query.even)));
  return hn::Add(sum, hn::Mul(hn::And(hn::ShiftRight<24>(set_bytes), mask), high(query.odd)));
}
#endif

// Folds one block's distances into a query's running results.
HWY_INLINE void Update(V32 constant, V32 sum, std::size_t block, std::size_t lane, LaneResults& result) {
  const D32 d32;
  const V32 distance = hn::Sub(constant, hn::Add(sum, sum));
  const V32 best = hn::Load(d32, result.best + lane);
  const V32 second = hn::Load(d32, result.second + lane);
  const V32 best_block = hn::Load(d32, result.block + lane);
  const V32 this_block = hn::Set(d32, static_cast<std::int32_t>(block));
  hn::Store(hn::Min(second, hn::Max(best, distance)), d32, result.second + lane);
  hn::Store(hn::Min(best, distance), d32, result.best + lane);
  hn::Store(hn::IfThenElse(hn::Lt(distance, best), this_block, best_block), d32, result.block + lane);
}

constexpr std::size_t kTile = 4;  // queries per tile: each load of the set serves all of them

struct QueryTile {
  QueryGroup groups[kTile][kDescriptorBytes / 4];
};

// The last tile repeats its last query.
QueryTile WidenTile(const PackedQueries& queries, std::size_t first) {
  QueryTile tile;
  for (std::size_t t = 0; t < kTile; ++t) {
    const std::int8_t* row = queries.rows.data() + std::min(first + t, queries.count - 1) * kDescriptorBytes;
    for (std::size_t g = 0; g < kDescriptorBytes / 4; ++g) tile.groups[t][g] = Widen(row + 4 * g);
  }
  return tile;
}

// The partial products of the tile's queries with the lanes of a block from `bytes` on.
HWY_INLINE void DotLanes(const QueryTile& tile, const std::uint8_t* bytes, V32& sum0, V32& sum1, V32& sum2, V32& sum3) {
  const D32 d32;
  sum0 = sum1 = sum2 = sum3 = hn::Zero(d32);
  for (std::size_t g = 0; g < kDescriptorBytes / 4; ++g) {
    const V32 loaded = hn::LoadU(d32, reinterpret_cast<const std::int32_t*>(bytes + g * 4 * kBlockDescriptors));
    sum0 = AddDot4(loaded, tile.groups[0][g], sum0);
    sum1 = AddDot4(loaded, tile.groups[1][g], sum1);
    sum2 = AddDot4(loaded, tile.groups[2][g], sum2);
    sum3 = AddDot4(loaded, tile.groups[3][g], sum3);
  }
}

void FindNearestTwoTarget(const PackedQueries& queries, const PackedDescriptors& set, std::span<NearestTwo> out) {
  const D32 d32;
  for (std::size_t first = 0; first < queries.count; first += kTile) {
    const QueryTile tile = WidenTile(queries, first);
    LaneResults results[kTile];
    for (LaneResults& result : results) {
      std::fill_n(result.best, kBlockDescriptors, 1 << 30);
      std::fill_n(result.second, kBlockDescriptors, 1 << 30);
      std::fill_n(result.block, kBlockDescriptors, 0);
    }
    for (std::size_t block = 0; block < set.block_count(); ++block) {
      for (std::size_t lane = 0; lane < kBlockDescriptors; lane += hn::Lanes(d32)) {
        V32 sum0, sum1, sum2, sum3;
        DotLanes(tile, set.blocks.data() + block * kBlockBytes + lane * 4, sum0, sum1, sum2, sum3);
        const V32 constant = hn::LoadU(d32, set.constant.data() + block * kBlockDescriptors + lane);
        Update(constant, sum0, block, lane, results[0]);
        Update(constant, sum1, block, lane, results[1]);
        Update(constant, sum2, block, lane, results[2]);
        Update(constant, sum3, block, lane, results[3]);
      }
    }
    for (std::size_t t = 0; t < std::min(kTile, queries.count - first); ++t) {
      out[first + t] = ReduceLanes(results[t], queries.squared[first + t], set.count);
    }
  }
}

// Inserts the lanes that are nearer than the current k-th nearest.
HWY_INLINE void Admit(V32 constant, V32 sum, std::size_t first_index, KNearest& found) {
  const D32 d32;
  const V32 distance = hn::Sub(constant, hn::Add(sum, sum));
  if (hn::AllFalse(d32, hn::Lt(distance, hn::Set(d32, found.Worst())))) return;
  HWY_ALIGN std::int32_t distances[kBlockDescriptors];
  hn::Store(distance, d32, distances);
  for (std::size_t i = 0; i < hn::Lanes(d32); ++i) {
    found.Insert(distances[i], static_cast<std::uint32_t>(first_index + i));
  }
}

void FindNearestKTarget(const PackedQueries& queries, const PackedDescriptors& set, std::size_t k,
                        std::span<Neighbour> out) {
  const D32 d32;
  for (std::size_t first = 0; first < queries.count; first += kTile) {
    const QueryTile tile = WidenTile(queries, first);
    std::vector<KNearest> found(kTile, KNearest(k));
    for (std::size_t block = 0; block < set.block_count(); ++block) {
      for (std::size_t lane = 0; lane < kBlockDescriptors; lane += hn::Lanes(d32)) {
        V32 sum0, sum1, sum2, sum3;
        DotLanes(tile, set.blocks.data() + block * kBlockBytes + lane * 4, sum0, sum1, sum2, sum3);
        const std::size_t index = block * kBlockDescriptors + lane;
        const V32 constant = hn::LoadU(d32, set.constant.data() + index);
        Admit(constant, sum0, index, found[0]);
        Admit(constant, sum1, index, found[1]);
        Admit(constant, sum2, index, found[2]);
        Admit(constant, sum3, index, found[3]);
      }
    }
    for (std::size_t t = 0; t < std::min(kTile, queries.count - first); ++t) {
      found[t].Write(queries.squared[first + t], &out[(first + t) * k]);
    }
  }
}

const char* TargetName() { return hwy::TargetName(HWY_TARGET); }

}  // namespace victorious::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace victorious::kernels {

HWY_EXPORT(FindNearestTwoTarget);
HWY_EXPORT(FindNearestKTarget);
HWY_EXPORT(TargetName);

void FindNearestTwoSimd(const PackedQueries& queries, const PackedDescriptors& set, std::span<NearestTwo> out) {
  HWY_DYNAMIC_DISPATCH(FindNearestTwoTarget)(queries, set, out);
}

void FindNearestKSimd(const PackedQueries& queries, const PackedDescriptors& set, std::size_t k,
                      std::span<Neighbour> out) {
  HWY_DYNAMIC_DISPATCH(FindNearestKTarget)(queries, set, k, out);
}

const char* NearestTwoTargetName() { return HasVnni() ? "avx512_vnni" : HWY_DYNAMIC_DISPATCH(TargetName)(); }

}  // namespace victorious::kernels
#endif  // HWY_ONCE

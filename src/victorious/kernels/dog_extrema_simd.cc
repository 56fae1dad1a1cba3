// FindDogExtrema on any vector width, through Highway.
#include <algorithm>
#include <bit>

#include "victorious/kernels/dog_extrema.h"
#include "victorious/kernels/no_sve.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "victorious/kernels/dog_extrema_simd.cc"
#include <hwy/foreach_target.h>
// Highway requires this order: after foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace victorious::kernels::HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR

std::size_t FindDogExtremaTarget(const LevelRows& rows, std::int32_t first_x, std::int32_t end_x,
                                 std::int16_t threshold, DogExtremum* out) {
  return FindDogExtremaRef(rows, first_x, end_x, threshold, out);
}

#else

namespace hn = hwy::HWY_NAMESPACE;

using D16 = hn::CappedTag<std::int16_t, kRowMultiple>;
using V16 = hn::Vec<D16>;

constexpr std::size_t kLayers = kSearchedLayers + 2;  // of differences
constexpr std::int32_t kStrip = 512;                  // columns at a time: the ranges of a strip stay in the L1 cache

// The lowest and highest difference of each column's three rows, for the columns of a strip and a vector around it.
struct ColumnRanges {
  HWY_ALIGN std::int16_t lowest[kLayers][kStrip + 2 * kRowMultiple];
  HWY_ALIGN std::int16_t highest[kLayers][kStrip + 2 * kRowMultiple];
};

HWY_INLINE V16 Difference(const LevelRows& rows, std::size_t layer, std::size_t row, std::int32_t x) {
  const D16 d;
  return hn::Sub(hn::LoadU(d, rows.row[layer + 1][row] + x), hn::LoadU(d, rows.row[layer][row] + x));
}

// Fills in the columns from x on, as many as a vector has lanes; `at` is their place in `ranges`.
HWY_INLINE void StoreColumnRanges(const LevelRows& rows, std::int32_t x, std::size_t at, ColumnRanges& ranges) {
  const D16 d;
  V16 level[3];
  for (std::size_t row = 0; row < 3; ++row) level[row] = hn::LoadU(d, rows.row[0][row] + x);
  for (std::size_t layer = 0; layer < kLayers; ++layer) {
    V16 difference[3];
    for (std::size_t row = 0; row < 3; ++row) {
      const V16 next = hn::LoadU(d, rows.row[layer + 1][row] + x);
      difference[row] = hn::Sub(next, level[row]);
      level[row] = next;
    }
    hn::StoreU(hn::Min(hn::Min(difference[0], difference[1]), difference[2]), d, ranges.lowest[layer] + at);
    hn::StoreU(hn::Max(hn::Max(difference[0], difference[1]), difference[2]), d, ranges.highest[layer] + at);
  }
}

// Over three rows and three columns.
HWY_INLINE V16 LowestAround(const ColumnRanges& ranges, std::size_t layer, std::size_t at) {
  const D16 d;
  const std::int16_t* low = ranges.lowest[layer] + at;
  return hn::Min(hn::Min(hn::LoadU(d, low - 1), hn::LoadU(d, low)), hn::LoadU(d, low + 1));
}

HWY_INLINE V16 HighestAround(const ColumnRanges& ranges, std::size_t layer, std::size_t at) {
  const D16 d;
  const std::int16_t* high = ranges.highest[layer] + at;
  return hn::Max(hn::Max(hn::LoadU(d, high - 1), hn::LoadU(d, high)), hn::LoadU(d, high + 1));
}

// bits[layer]: the extrema among the lanes from x on. False if there are none.
HWY_INLINE bool FindInVector(const LevelRows& rows, const ColumnRanges& ranges, std::int32_t x, std::size_t at,
                             V16 threshold, std::uint32_t (&bits)[kLayers]) {
  const D16 d;
  V16 difference[kLayers];
  auto exceeds = hn::FirstN(d, 0);
  for (std::size_t layer = 1; layer <= kSearchedLayers; ++layer) {
    difference[layer] = Difference(rows, layer, 1, x);
    exceeds = hn::Or(exceeds, hn::Gt(hn::Abs(difference[layer]), threshold));
  }
  if (hn::AllFalse(d, exceeds)) return false;
  V16 lowest[kLayers];
  V16 highest[kLayers];
  for (std::size_t layer = 0; layer < kLayers; ++layer) {
    lowest[layer] = LowestAround(ranges, layer, at);
    highest[layer] = HighestAround(ranges, layer, at);
  }
  const V16 negative = hn::Neg(threshold);
  bool any = false;
  for (std::size_t layer = 1; layer <= kSearchedLayers; ++layer) {
    const V16 high = hn::Max(highest[layer], hn::Max(highest[layer - 1], highest[layer + 1]));
    const V16 low = hn::Min(lowest[layer], hn::Min(lowest[layer - 1], lowest[layer + 1]));
    const V16 here = difference[layer];
    const auto mask = hn::Or(hn::And(hn::Eq(here, high), hn::Gt(here, threshold)),
                             hn::And(hn::Eq(here, low), hn::Lt(here, negative)));
    bits[layer] = 0;
    if (hn::AllFalse(d, mask)) continue;
    any = true;
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, mask, bytes);
    for (std::uint32_t byte = 0; byte < 4; ++byte) bits[layer] |= static_cast<std::uint32_t>(bytes[byte]) << (8 * byte);
  }
  return any;
}

std::size_t FindDogExtremaTarget(const LevelRows& rows, std::int32_t first_x, std::int32_t end_x,
                                 std::int16_t threshold, DogExtremum* out) {
  const D16 d;
  const auto lanes = static_cast<std::int32_t>(hn::Lanes(d));
  const V16 limit = hn::Set(d, threshold);
  // Vectors start at multiples of their lanes, so that they end within the padding of the row.
  const auto down = [&](std::int32_t x) { return x / lanes * lanes; };
  std::size_t count = 0;
  ColumnRanges ranges;
  for (std::int32_t strip = down(first_x); strip < end_x; strip += kStrip) {
    const std::int32_t strip_end = std::min(strip + kStrip, end_x);
    const auto place = [&](std::int32_t x) { return static_cast<std::size_t>(x - strip + kRowMultiple); };
    for (std::int32_t x = down(std::max(strip, first_x) - 1); x <= strip_end; x += lanes) {
      StoreColumnRanges(rows, x, place(x), ranges);
    }
    for (std::int32_t x = strip; x < strip_end; x += lanes) {
      std::uint32_t bits[kLayers];
      if (!FindInVector(rows, ranges, x, place(x), limit, bits)) continue;
      for (std::uint32_t lane_bits = bits[1] | bits[2] | bits[3]; lane_bits != 0; lane_bits &= lane_bits - 1) {
        const int lane = std::countr_zero(lane_bits);
        if (x + lane < first_x || x + lane >= end_x) continue;
        for (std::size_t layer = 1; layer <= kSearchedLayers; ++layer) {
          if ((bits[layer] >> lane & 1) != 0) out[count++] = {x + lane, static_cast<std::int32_t>(layer)};
        }
      }
    }
  }
  return count;
}

#endif

}  // namespace victorious::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace victorious::kernels {

HWY_EXPORT(FindDogExtremaTarget);

std::size_t FindDogExtrema(const LevelRows& rows, std::int32_t first_x, std::int32_t end_x, std::int16_t threshold,
                           DogExtremum* out) {
  return HWY_DYNAMIC_DISPATCH(FindDogExtremaTarget)(rows, first_x, end_x, threshold, out);
}

}  // namespace victorious::kernels
#endif  // HWY_ONCE

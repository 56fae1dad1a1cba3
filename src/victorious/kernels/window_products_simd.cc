// WindowProducts on any vector width, through Highway: compiled once for each instruction set, chosen at run time.
//
// Some templates at four positions side by side share all loads: a vector of a template's row is multiplied with those
// of four windows, and a vector of a window with those of all these templates. Rows of templates are padded with zeros
// to whole vectors, so that what follows a window in the map counts for nothing. The map is copied, so that it can be
// read beyond its end. 36 templates of 24 x 24 cells of 8 values on one core (Xeon): 98 thousand million products a
// second with AVX-512, 65 with AVX2, 15 by the reference.
#include <algorithm>

#include "victorious/kernels/blocks.h"
#include "victorious/kernels/no_sve.h"
#include "victorious/kernels/window_products.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "victorious/kernels/window_products_simd.cc"
#include <hwy/foreach_target.h>
// Highway requires this order: after foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace victorious::kernels::HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR

void WindowProductsTarget(const MapView& map, const BankView& bank, std::span<std::int32_t> out) {
  WindowProductsRef(map, bank, out);
}

#else

namespace hn = hwy::HWY_NAMESPACE;

using D16 = hn::CappedTag<std::int16_t, 32>;
using D32 = hn::RepartitionToWide<D16>;
using V16 = hn::Vec<D16>;
using V32 = hn::Vec<D32>;

constexpr std::size_t kLanes = hn::MaxLanes(D16());
constexpr std::size_t kPositions = 4;                     // of a block, side by side
constexpr std::size_t kTemplates = kLanes == 32 ? 6 : 3;  // of a block: AVX-512 has twice the registers

using DSums = hn::FixedTag<std::int32_t, kPositions>;

// The sums of the blocks of 4 lanes.
template <typename D>
HWY_INLINE hn::Vec<DSums> AddBlocks(D d, hn::Vec<D> v) {
  if constexpr (hn::MaxLanes(d) == 4) {
    return v;
  } else {
    const hn::Half<D> half;
    return AddBlocks(half, hn::Add(hn::LowerHalf(half, v), hn::UpperHalf(half, v)));
  }
}

// The sums of the lanes of each of four vectors.
HWY_INLINE hn::Vec<DSums> SumLanes(V32 a, V32 b, V32 c, V32 d) {
  const D32 d32;
  const hn::Repartition<std::int64_t, D32> d64;
  const auto ab = hn::BitCast(d64, hn::Add(hn::InterleaveLower(d32, a, b), hn::InterleaveUpper(d32, a, b)));
  const auto cd = hn::BitCast(d64, hn::Add(hn::InterleaveLower(d32, c, d), hn::InterleaveUpper(d32, c, d)));
  const V32 low = hn::BitCast(d32, hn::InterleaveLower(d64, ab, cd));
  const V32 high = hn::BitCast(d32, hn::InterleaveUpper(d64, ab, cd));
  return AddBlocks(d32, hn::Add(low, high));
}

struct Geometry {
  std::size_t depth;
  std::size_t map_stride;   // values of a row of the map
  std::size_t height;       // rows of a template
  std::size_t row_vectors;  // of a row of a template
  std::size_t out_rows;     // positions
  std::size_t out_cols;
};

// The products of a block of `templates` templates with windows side by side, from `cells` on. Not inlined, and all
// loops over the sums unrolled: else GCC would keep some of them in memory.
template <std::size_t templates>
HWY_NOINLINE void MultiplyBlock(const std::int16_t* cells, const std::int16_t* values, const Geometry& geometry,
                                std::int32_t (&products)[templates][kPositions]) {
  const D16 d16;
  const D32 d32;
  V32 sums[templates][kPositions];
  V32 rests[templates][kPositions];  // on some instruction sets a half of the sum
#pragma GCC unroll 8
  for (std::size_t t = 0; t < templates; ++t) {
#pragma GCC unroll 8
    for (std::size_t p = 0; p < kPositions; ++p) sums[t][p] = rests[t][p] = hn::Zero(d32);
  }
  for (std::size_t r = 0; r < geometry.height; ++r) {
    for (std::size_t v = 0; v < geometry.row_vectors; ++v) {
      V16 windows[kPositions];
#pragma GCC unroll 8
      for (std::size_t p = 0; p < kPositions; ++p) {
        windows[p] = hn::LoadU(d16, cells + v * kLanes + p * geometry.depth);
      }
#pragma GCC unroll 8
      for (std::size_t t = 0; t < templates; ++t) {
        const V16 of_template = hn::Load(d16, values);
        values += kLanes;
#pragma GCC unroll 8
        for (std::size_t p = 0; p < kPositions; ++p) {
          sums[t][p] = hn::ReorderWidenMulAccumulate(d32, windows[p], of_template, sums[t][p], rests[t][p]);
        }
      }
    }
    cells += geometry.map_stride;
  }
#pragma GCC unroll 8
  for (std::size_t t = 0; t < templates; ++t) {
#pragma GCC unroll 8
    for (std::size_t p = 0; p < kPositions; ++p) sums[t][p] = hn::Add(sums[t][p], rests[t][p]);
    hn::Store(SumLanes(sums[t][0], sums[t][1], sums[t][2], sums[t][3]), DSums(), products[t]);
  }
}

// The vectors of a block's templates side by side, in the order of MultiplyBlock.
void PackBlock(const std::int16_t* values, std::size_t templates, std::size_t row_values, const Geometry& geometry,
               std::int16_t* packed) {
  for (std::size_t t = 0; t < templates; ++t) {
    std::int16_t* to = packed + t * kLanes;
    for (std::size_t r = 0; r < geometry.height; ++r) {
      for (std::size_t at = 0; at < row_values; at += kLanes) {
        const std::size_t count = std::min(kLanes, row_values - at);
        std::fill_n(std::copy_n(values + at, count, to), kLanes - count, std::int16_t{0});
        to += templates * kLanes;
      }
      values += row_values;
    }
  }
}

// The products of a block of `templates` templates at all positions.
template <std::size_t templates>
void MultiplyEverywhere(const std::int16_t* padded_map, const std::int16_t* packed, const Geometry& geometry,
                        std::int32_t* out) {
  HWY_ALIGN std::int32_t products[templates][kPositions];
  for (std::size_t y = 0; y < geometry.out_rows; ++y) {
    for (std::size_t x = 0; x < geometry.out_cols; x += kPositions) {
      MultiplyBlock(padded_map + y * geometry.map_stride + x * geometry.depth, packed, geometry, products);
      const std::size_t positions = std::min(kPositions, geometry.out_cols - x);
      for (std::size_t t = 0; t < templates; ++t) {
        std::copy_n(products[t], positions, out + (t * geometry.out_rows + y) * geometry.out_cols + x);
      }
    }
  }
}

// The same for a number of templates of at most `most`.
template <std::size_t most>
void MultiplyTemplates(std::size_t templates, const std::int16_t* padded_map, const std::int16_t* packed,
                       const Geometry& geometry, std::int32_t* out) {
  if (templates == most) return MultiplyEverywhere<most>(padded_map, packed, geometry, out);
  if constexpr (most > 1) MultiplyTemplates<most - 1>(templates, padded_map, packed, geometry, out);
}

void WindowProductsTarget(const MapView& map, const BankView& bank, std::span<std::int32_t> out) {
  const std::size_t row_values = bank.width * map.depth;
  const Geometry geometry = {.depth = map.depth,
                             .map_stride = map.cols * map.depth,
                             .height = bank.height,
                             .row_vectors = (row_values + kLanes - 1) / kLanes,
                             .out_rows = map.rows - bank.height + 1,
                             .out_cols = map.cols - bank.width + 1};
  const std::size_t map_values = map.rows * geometry.map_stride;
  BlockVector<std::int16_t> padded_map(map_values + (kPositions - 1) * map.depth + kLanes);
  std::copy_n(map.values, map_values, padded_map.begin());
  BlockVector<std::int16_t> packed(kTemplates * bank.height * geometry.row_vectors * kLanes);
  for (std::size_t first = 0; first < bank.templates; first += kTemplates) {
    const std::size_t templates = std::min(kTemplates, bank.templates - first);
    PackBlock(bank.values + first * bank.height * row_values, templates, row_values, geometry, packed.data());
    MultiplyTemplates<kTemplates>(templates, padded_map.data(), packed.data(), geometry,
                                  &out[first * geometry.out_rows * geometry.out_cols]);
  }
}

#endif

}  // namespace victorious::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace victorious::kernels {

HWY_EXPORT(WindowProductsTarget);

void WindowProducts(const MapView& map, const BankView& bank, std::span<std::int32_t> out) {
  HWY_DYNAMIC_DISPATCH(WindowProductsTarget)(map, bank, out);
}

}  // namespace victorious::kernels
#endif  // HWY_ONCE

// DescribeSift on any vector width, through Highway.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "victorious/kernels/no_sve.h"
#include "victorious/kernels/sift_descriptor.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "victorious/kernels/sift_descriptor_simd.cc"
#include <hwy/foreach_target.h>
// Highway requires this order: after foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace victorious::kernels::HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR

void DescribeSiftTarget(const LevelView& level, const DescriptorGrid& grid,
                        std::span<std::uint8_t, kDescriptorBytes> out) {
  DescribeSiftRef(level, grid, out);
}

#else

namespace hn = hwy::HWY_NAMESPACE;

// At most one row of gradients, or half of one in 32 bits.
using D16 = hn::CappedTag<std::int16_t, kGridSamples>;
using D32 = hn::Repartition<std::int32_t, D16>;
using DF = hn::Rebind<float, D32>;
using V16 = hn::Vec<D16>;
using V32 = hn::Vec<D32>;
using VF = hn::Vec<DF>;

constexpr std::size_t kSide = kGridSamples;
constexpr std::size_t kCells = kCellsPerSide;
constexpr std::size_t kDirections = kDescriptorDirections;

// even(a) * even(b) + odd(a) * odd(b) of the 16-bit lanes of each 32-bit lane.
#if HWY_TARGET == HWY_SSSE3 || HWY_TARGET == HWY_SSE4 || HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3 || \
    HWY_TARGET == HWY_AVX3_DL
HWY_INLINE V32 MultiplyPairs(V16 a, V16 b) {  // pmaddwd
  const D32 d;
  V32 unused = hn::Zero(d);
  return hn::ReorderWidenMulAccumulate(d, a, b, hn::Zero(d), unused);
}
#else
HWY_INLINE V32 MultiplyPairs(V16 a, V16 b) {
  const D32 d;
  const V32 a32 = hn::BitCast(d, a);
  const V32 b32 = hn::BitCast(d, b);
  const auto even = [](V32 v) { return hn::ShiftRight<16>(hn::ShiftLeft<16>(v)); };
  return hn::Add(hn::Mul(even(a32), even(b32)), hn::Mul(hn::ShiftRight<16>(a32), hn::ShiftRight<16>(b32)));
}
#endif

constexpr std::size_t kAllPoints = kGridPoints * kGridPoints;
constexpr std::size_t kPaddedPoints = (kAllPoints + kSide - 1) / kSide * kSide;

struct Points {
  HWY_ALIGN std::int16_t value[kPaddedPoints + kSide];   // row by row, kGridPoints each
  HWY_ALIGN std::int16_t inside[kPaddedPoints + kSide];  // all bits, or none
  bool all_inside;
};

// 2 i - 17 and 2 j - 17 of each point.
struct PointIndices {
  HWY_ALIGN std::int32_t along_u[kPaddedPoints];
  HWY_ALIGN std::int32_t along_v[kPaddedPoints];
};

const PointIndices& GetPointIndices() {
  static const PointIndices kIndices = [] {
    PointIndices indices;
    for (std::size_t n = 0; n < kPaddedPoints; ++n) {
      const auto point = static_cast<std::int32_t>(std::min(n, kAllPoints - 1));
      indices.along_u[n] = 2 * (point % kGridPoints) - (kGridPoints - 1);
      indices.along_v[n] = 2 * (point / kGridPoints) - (kGridPoints - 1);
    }
    return indices;
  }();
  return kIndices;
}

// Whether all points lie inside the level.
bool IsGridInside(const LevelView& level, const DescriptorGrid& grid) {
  const std::int32_t reach = (kGridPoints - 1) * (std::abs(grid.half_x) + std::abs(grid.half_y));
  const auto within = [&](std::int32_t at, std::int32_t fraction, int size) {
    return at + ((fraction - reach) >> 16) >= 0 && at + ((fraction + reach) >> 16) < size - 1;
  };
  return within(grid.x, grid.fraction_x, level.width) && within(grid.y, grid.fraction_y, level.height);
}

void SamplePoints(const LevelView& level, const DescriptorGrid& grid, Points& points) {
  const D32 d;
  const hn::Rebind<std::int16_t, D32> d16;
  const PointIndices& indices = GetPointIndices();
  points.all_inside = IsGridInside(level, grid);
  const V32 last_x = hn::Set(d, (level.width - 1) << 8);
  const V32 last_y = hn::Set(d, (level.height - 1) << 8);
  const V32 half_x = hn::Set(d, grid.half_x);
  const V32 half_y = hn::Set(d, grid.half_y);
  const V32 fraction_x = hn::Set(d, grid.fraction_x);
  const V32 fraction_y = hn::Set(d, grid.fraction_y);
  const V32 origin_x = hn::Set(d, grid.x << 8);
  const V32 origin_y = hn::Set(d, grid.y << 8);
  const V32 stride = hn::Set(d, static_cast<std::int32_t>(level.stride));
  const V32 zero = hn::Zero(d);
  const V32 byte = hn::Set(d, 255);
  const V32 unit = hn::Set(d, 256);
  // In three passes, so that no vector is loaded right after its parts are stored.
  HWY_ALIGN std::int32_t upper[kPaddedPoints];      // index of the pixel to the upper left
  HWY_ALIGN std::int32_t fractions[kPaddedPoints];  // right + 65536 below, px / 256
  for (std::size_t n = 0; n < kPaddedPoints; n += hn::Lanes(d)) {
    const V32 a = hn::Load(d, indices.along_u + n);
    const V32 b = hn::Load(d, indices.along_v + n);
    const V32 x = hn::Add(hn::ShiftRight<8>(hn::Add(fraction_x, hn::Sub(hn::Mul(a, half_x), hn::Mul(b, half_y)))),
                          origin_x);  // px / 256
    const V32 y =
        hn::Add(hn::ShiftRight<8>(hn::Add(fraction_y, hn::Add(hn::Mul(a, half_y), hn::Mul(b, half_x)))), origin_y);
    const V32 near_x = hn::Min(hn::Max(x, zero), last_x);
    const V32 near_y = hn::Min(hn::Max(y, zero), last_y);
    hn::Store(hn::Add(hn::Mul(hn::ShiftRight<8>(near_y), stride), hn::ShiftRight<8>(near_x)), d, upper + n);
    hn::Store(hn::Or(hn::And(near_x, byte), hn::ShiftLeft<16>(hn::And(near_y, byte))), d, fractions + n);
    if (points.all_inside) continue;
    const auto inside =
        hn::And(hn::And(hn::Eq(x, near_x), hn::Lt(x, last_x)), hn::And(hn::Eq(y, near_y), hn::Lt(y, last_y)));
    hn::Store(hn::DemoteTo(d16, hn::VecFromMask(d, inside)), d16, points.inside + n);
  }
  // The pixels x and x + 1 as one word. Scalar loads are no slower than gathers, which not every processor has. At the
  // last row and column the pixels beyond have the weight 0.
  HWY_ALIGN std::int32_t upper_pixels[kPaddedPoints];
  HWY_ALIGN std::int32_t lower_pixels[kPaddedPoints];
  const std::int16_t* const pixels = level.data;
  const std::int16_t* const next_row = level.data + level.stride;
  constexpr std::size_t kUnrolled = 4;
  static_assert(kPaddedPoints % kUnrolled == 0);
  for (std::size_t n = 0; n < kPaddedPoints; n += kUnrolled) {
    for (std::size_t m = n; m < n + kUnrolled; ++m) {
      const std::ptrdiff_t index = upper[m];
      std::memcpy(&upper_pixels[m], pixels + index, sizeof(upper_pixels[m]));
      std::memcpy(&lower_pixels[m], next_row + index, sizeof(lower_pixels[m]));
    }
  }
  for (std::size_t n = 0; n < kPaddedPoints; n += hn::Lanes(d)) {
    const V32 both = hn::Load(d, fractions + n);
    const V32 right = hn::And(both, byte);
    const V32 below = hn::ShiftRight<16>(both);
    const V16 weights = hn::BitCast(D16(), hn::Or(hn::Sub(unit, right), hn::ShiftLeft<16>(right)));
    const V32 top = MultiplyPairs(hn::BitCast(D16(), hn::Load(d, upper_pixels + n)), weights);
    const V32 bottom = MultiplyPairs(hn::BitCast(D16(), hn::Load(d, lower_pixels + n)), weights);
    const V32 sum = hn::Add(hn::Mul(top, hn::Sub(unit, below)), hn::Mul(bottom, below));
    const V32 value = hn::ShiftRight<16>(hn::Add(sum, hn::Set(d, 1 << 15)));
    hn::Store(hn::DemoteTo(d16, value), d16, points.value + n);
  }
}

// The parts of the gradients of row j, from column i on; SplitGradient of sift_descriptor_ref.cc.
HWY_INLINE void SplitGradients(const Points& points, std::size_t j, std::size_t i, V16 (&parts)[kDirections]) {
  const D16 d;
  const std::size_t n = (j + 1) * kGridPoints + i + 1;
  V16 u = hn::Sub(hn::LoadU(d, points.value + n + 1), hn::LoadU(d, points.value + n - 1));
  V16 v = hn::Sub(hn::LoadU(d, points.value + n + kGridPoints), hn::LoadU(d, points.value + n - kGridPoints));
  if (!points.all_inside) {
    const V16 inside = hn::LoadU(d, points.inside + n);
    u = hn::And(u, inside);
    v = hn::And(v, inside);
  }
  const V16 zero = hn::Zero(d);
  const V16 right = hn::Max(u, zero);
  const V16 left = hn::Max(hn::Neg(u), zero);
  const V16 down = hn::Max(v, zero);
  const V16 up = hn::Max(hn::Neg(v), zero);
  const V16 along_u = hn::Add(right, left);
  const V16 along_v = hn::Add(down, up);
  const auto beyond = [&](V16 a, V16 b) { return hn::Max(hn::Sub(a, b), zero); };
  parts[0] = beyond(right, along_v);
  parts[1] = hn::Min(right, up);
  parts[2] = beyond(up, along_u);
  parts[3] = hn::Min(left, up);
  parts[4] = beyond(left, along_v);
  parts[5] = hn::Min(left, down);
  parts[6] = beyond(down, along_u);
  parts[7] = hn::Min(right, down);
}

constexpr std::size_t kPairs = kSide / 2;  // of rows

// The weights of a pair of rows in a cell as two 16-bit lanes, and the pairs that a cell needs.
struct PairWeights {
  std::int32_t weight[kCells][kPairs];
  std::size_t first[kCells];
  std::size_t end[kCells];
};

const PairWeights& RowPairWeights() {
  static const PairWeights kWeights = [] {
    PairWeights pairs{};
    const CellWeights& weights = DescriptorCellWeights();
    for (std::size_t c = 0; c < kCells; ++c) {
      pairs.first[c] = kPairs;
      for (std::size_t p = 0; p < kPairs; ++p) {
        const auto bits = [&](std::size_t i) {
          return static_cast<std::uint32_t>(static_cast<std::uint16_t>(weights[c][i]));
        };
        pairs.weight[c][p] = static_cast<std::int32_t>(bits(2 * p) | bits(2 * p + 1) << 16);
        if (pairs.weight[c][p] == 0) continue;
        pairs.first[c] = std::min(pairs.first[c], p);
        pairs.end[c] = p + 1;
      }
    }
    return pairs;
  }();
  return kWeights;
}

// Sums along y: columns[r][d] holds 16 column sums, rounded to 16 bits.
void SumColumns(const Points& points, std::int16_t (&columns)[kCells][kDirections][kSide]) {
  const D16 d16;
  const D32 d;
  const PairWeights& weights = RowPairWeights();
  const std::size_t lanes = hn::Lanes(d16);
  // The parts of two rows interleaved, in the lower and the upper half of the vectors' blocks.
  HWY_ALIGN std::int16_t interleaved[kPairs][kDirections][2][kSide];
  for (std::size_t i = 0; i < kSide; i += lanes) {
    for (std::size_t p = 0; p < kPairs; ++p) {
      V16 even[kDirections];
      V16 odd[kDirections];
      SplitGradients(points, 2 * p, i, even);
      SplitGradients(points, 2 * p + 1, i, odd);
      for (std::size_t k = 0; k < kDirections; ++k) {
        hn::Store(hn::InterleaveLower(d16, even[k], odd[k]), d16, interleaved[p][k][0]);
        hn::Store(hn::InterleaveUpper(d16, even[k], odd[k]), d16, interleaved[p][k][1]);
      }
    }
    const V32 half = hn::Set(d, 1 << 15);
    for (std::size_t r = 0; r < kCells; ++r) {
      for (std::size_t k = 0; k < kDirections; ++k) {
        V32 lower = half;
        V32 upper = half;
        for (std::size_t p = weights.first[r]; p < weights.end[r]; ++p) {
          const V16 weight = hn::BitCast(d16, hn::Set(d, weights.weight[r][p]));
          lower = hn::Add(lower, MultiplyPairs(hn::Load(d16, interleaved[p][k][0]), weight));
          upper = hn::Add(upper, MultiplyPairs(hn::Load(d16, interleaved[p][k][1]), weight));
        }
        // Undoes the interleaving: both work within blocks of 128 bits.
        const V16 sums = hn::ReorderDemote2To(d16, hn::ShiftRight<16>(lower), hn::ShiftRight<16>(upper));
        hn::StoreU(sums, d16, columns[r][k] + i);
      }
    }
  }
}

// The sums of neighbouring lanes of a, then those of b.
HWY_INLINE V32 AddNeighbours(V32 a, V32 b) {
  const D32 d;
  return hn::Add(hn::ConcatEven(d, b, a), hn::ConcatOdd(d, b, a));
}

// out[n] = the sum of the lanes of v[n], kDirections of them; v is overwritten.
HWY_INLINE void SumLanes(V32 (&v)[kDirections], std::int32_t* out) {
  const D32 d;
  std::size_t count = kDirections;
  for (std::size_t lanes = hn::Lanes(d); lanes > 1; lanes /= 2, count /= 2) {
    for (std::size_t n = 0; n < count / 2; ++n) v[n] = AddNeighbours(v[2 * n], v[2 * n + 1]);
  }
  for (std::size_t n = 0; n < count; ++n) hn::StoreU(v[n], d, out + n * hn::Lanes(d));
}

void SumCells(const std::int16_t (&columns)[kCells][kDirections][kSide], std::int32_t* out) {
  const D16 d16;
  const D32 d;
  const CellWeights& weights = DescriptorCellWeights();
  for (std::size_t r = 0; r < kCells; ++r) {
    for (std::size_t c = 0; c < kCells; ++c) {
      V32 sums[kDirections];
      for (std::size_t k = 0; k < kDirections; ++k) {
        sums[k] = hn::Zero(d);
        for (std::size_t i = 0; i < kSide; i += hn::Lanes(d16)) {
          sums[k] =
              hn::Add(sums[k], MultiplyPairs(hn::LoadU(d16, columns[r][k] + i), hn::LoadU(d16, weights[c].data() + i)));
        }
      }
      SumLanes(sums, out + (r * kCells + c) * kDirections);
    }
  }
}

// In the order that sift_descriptor_ref.cc defines.
float SumOfSquares(const float* values) {
  const DF d;
  constexpr std::size_t kOrder = 8;
  HWY_ALIGN float sums[kOrder];
  for (std::size_t part = 0; part < kOrder; part += hn::Lanes(d)) {
    VF sum = hn::Zero(d);
    for (std::size_t i = part; i < kDescriptorBytes; i += kOrder) {
      const VF value = hn::Load(d, values + i);
      sum = hn::Add(sum, hn::Mul(value, value));
    }
    hn::Store(sum, d, sums + part);
  }
  for (std::size_t distance = kOrder / 2; distance > 0; distance /= 2) {
    for (std::size_t i = 0; i < distance; ++i) sums[i] += sums[i + distance];
  }
  return sums[0];
}

void WriteBytes(const std::int32_t* sums, std::uint8_t* out) {
  const DF d;
  const D32 d32;
  const hn::Rebind<std::uint8_t, DF> d8;
  static constexpr float kFactors[kDirections] = {1, kSqrt2, 1, kSqrt2, 1, kSqrt2, 1, kSqrt2};
  HWY_ALIGN float values[kDescriptorBytes];
  for (std::size_t i = 0; i < kDescriptorBytes; i += hn::Lanes(d)) {
    const VF factor = hn::LoadU(d, kFactors + i % kDirections);
    hn::Store(hn::Mul(hn::ConvertTo(d, hn::LoadU(d32, sums + i)), factor), d, values + i);
  }
  const VF limit = hn::Set(d, 0.2F * std::sqrt(SumOfSquares(values)));
  for (std::size_t i = 0; i < kDescriptorBytes; i += hn::Lanes(d)) {
    hn::Store(hn::Min(hn::Load(d, values + i), limit), d, values + i);
  }
  const float norm = std::sqrt(SumOfSquares(values));
  const VF factor = hn::Set(d, norm > 0 ? 512.0F / norm : 0.0F);
  for (std::size_t i = 0; i < kDescriptorBytes; i += hn::Lanes(d)) {
    const VF value = hn::Add(hn::Mul(hn::Load(d, values + i), factor), hn::Set(d, 0.5F));
    const V32 bytes = hn::ConvertTo(d32, hn::Min(value, hn::Set(d, 255.0F)));
    hn::StoreU(hn::DemoteTo(d8, bytes), d8, out + i);
  }
}

void DescribeSiftTarget(const LevelView& level, const DescriptorGrid& grid,
                        std::span<std::uint8_t, kDescriptorBytes> out) {
  Points points;
  SamplePoints(level, grid, points);
  HWY_ALIGN std::int16_t columns[kCells][kDirections][kSide];
  SumColumns(points, columns);
  HWY_ALIGN std::int32_t sums[kDescriptorBytes];
  SumCells(columns, sums);
  WriteBytes(sums, out.data());
}

#endif

}  // namespace victorious::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace victorious::kernels {

HWY_EXPORT(DescribeSiftTarget);

void DescribeSift(const LevelView& level, const DescriptorGrid& grid, std::span<std::uint8_t, kDescriptorBytes> out) {
  HWY_DYNAMIC_DISPATCH(DescribeSiftTarget)(level, grid, out);
}

}  // namespace victorious::kernels
#endif  // HWY_ONCE

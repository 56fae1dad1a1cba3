// The loops of gradient cells on any vector width, through Highway: compiled once for each instruction set, chosen at
// run time. Multiplications and additions are not fused, so that all give the same bits.
#include "victorious/kernels/gradient_rows.h"
#include "victorious/kernels/no_sve.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "victorious/kernels/gradient_rows_simd.cc"
#include <hwy/foreach_target.h>
// Highway requires this order: after foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace victorious::kernels::HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR

void OrientGradientsTarget(const float* above, const float* here, const float* below, std::size_t width,
                           std::size_t stride, float* bins) {
  OrientGradientsRef(above, here, below, width, stride, bins);
}
void ReduceGradientsTarget(const float* in, std::size_t columns, float* out) { ReduceGradientsRef(in, columns, out); }
void SumGradientRowsTarget(const std::array<const float*, kTriangleTaps>& rows, std::size_t count, float* out) {
  SumGradientRowsRef(rows, count, out);
}

void EncodeGradientsTarget(const float* sums, std::size_t stride, const float* energy, std::size_t cells, float noise2,
                           float scale, std::uint8_t* out) {
  EncodeGradientsRef(sums, stride, energy, cells, noise2, scale, out);
}

#else

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kMaxLanes = 16;
static_assert(2 * kMaxLanes + kTriangleReach < kGradientPadding);
using DF = hn::CappedTag<float, kMaxLanes>;
using VF = hn::Vec<DF>;

// atan(t) for 0 <= t <= 1 in orientations, 8 / pi; odd powers; the largest error is 2e-6.
constexpr float kBinsPerRadian = 2.5464790F;
constexpr float kAtan[] = {0.99997722F * kBinsPerRadian,  -0.33262277F * kBinsPerRadian, 0.19353998F * kBinsPerRadian,
                           -0.11642544F * kBinsPerRadian, 0.05264617F * kBinsPerRadian,  -0.01171866F * kBinsPerRadian};
constexpr float kTiny = 1e-20F;  // no division by 0

// The orientation of a gradient in [0, 8].
HWY_INLINE VF PositionOf(VF across, VF down) {
  const DF d;
  // The opposite gradient is that of the same edge.
  const VF sign = hn::IfThenElse(hn::Lt(down, hn::Zero(d)), hn::Set(d, -1.0F), hn::Set(d, 1.0F));
  const VF along_x = hn::Abs(across);
  const VF along_y = hn::Abs(down);
  const VF t = hn::Div(hn::Min(along_x, along_y), hn::Max(hn::Max(along_x, along_y), hn::Set(d, kTiny)));
  const VF t2 = hn::Mul(t, t);
  VF sum = hn::Set(d, kAtan[5]);
  for (int i = 4; i >= 0; --i) sum = hn::Add(hn::Mul(sum, t2), hn::Set(d, kAtan[i]));
  VF position = hn::Mul(t, sum);
  constexpr float kHalf = kGradientBins / 2;
  position = hn::IfThenElse(hn::Gt(along_y, along_x), hn::Sub(hn::Set(d, kHalf), position), position);
  const auto is_left = hn::Lt(hn::Mul(across, sign), hn::Zero(d));
  return hn::IfThenElse(is_left, hn::Sub(hn::Set(d, 2 * kHalf), position), position);
}

void OrientGradientsTarget(const float* above, const float* here, const float* below, std::size_t width,
                           std::size_t stride, float* bins) {
  const DF d;
  const VF zero = hn::Zero(d);
  const VF one = hn::Set(d, 1.0F);
  for (std::size_t x = 0; x < width; x += hn::Lanes(d)) {
    const VF across = hn::Sub(hn::LoadU(d, here + x + 1), hn::LoadU(d, here + x - 1));
    const VF down = hn::Sub(hn::LoadU(d, below + x), hn::LoadU(d, above + x));
    const VF magnitude = hn::Sqrt(hn::Add(hn::Mul(across, across), hn::Mul(down, down)));
    const VF position = PositionOf(across, down);
    for (std::size_t k = 0; k < kGradientBins; ++k) {
      const VF apart = hn::Abs(hn::Sub(position, hn::Set(d, static_cast<float>(k))));
      VF weight = hn::Max(zero, hn::Sub(one, apart));
      if (k == 0) {  // position 8 is 0
        weight = hn::Max(weight, hn::Sub(position, hn::Set(d, kGradientBins - 1.0F)));
      }
      hn::StoreU(hn::Mul(magnitude, weight), d, bins + k * stride + x);
    }
  }
}

void ReduceGradientsTarget(const float* in, std::size_t columns, float* out) {
  const DF d;
  const VF one = hn::Set(d, kTriangle[0]);
  const VF two = hn::Set(d, kTriangle[1]);
  const VF three = hn::Set(d, kTriangle[2]);
  const VF four = hn::Set(d, kTriangle[3]);
  for (std::size_t c = 0; c < columns; c += hn::Lanes(d)) {
    const float* const at = in + 2 * c;
    VF unused, odd_2, even_1, odd_1, even, odd, even1, odd1;  // of c - 2, c - 1, c, c + 1
    hn::LoadInterleaved2(d, at - 4, unused, odd_2);
    hn::LoadInterleaved2(d, at - 2, even_1, odd_1);
    hn::LoadInterleaved2(d, at, even, odd);
    hn::LoadInterleaved2(d, at + 2, even1, odd1);
    VF sum = hn::Add(hn::Mul(four, even), hn::Mul(three, hn::Add(odd_1, odd)));
    sum = hn::Add(sum, hn::Mul(two, hn::Add(even_1, even1)));
    sum = hn::Add(sum, hn::Mul(one, hn::Add(odd_2, odd1)));
    hn::StoreU(sum, d, out + c);
  }
}

void SumGradientRowsTarget(const std::array<const float*, kTriangleTaps>& rows, std::size_t count, float* out) {
  const DF d;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    VF sum = hn::Mul(hn::Set(d, kTriangle[kTriangleReach]), hn::LoadU(d, rows[kTriangleReach] + i));
    for (std::size_t t = 0; t < kTriangleReach; ++t) {
      const VF pair = hn::Add(hn::LoadU(d, rows[t] + i), hn::LoadU(d, rows[kTriangleTaps - 1 - t] + i));
      sum = hn::Add(sum, hn::Mul(hn::Set(d, kTriangle[t]), pair));
    }
    hn::StoreU(sum, d, out + i);
  }
}

void EncodeGradientsTarget(const float* sums, std::size_t stride, const float* energy, std::size_t cells, float noise2,
                           float scale, std::uint8_t* out) {
  const DF d;
  const hn::RebindToSigned<DF> d32;
  const hn::Repartition<std::uint8_t, DF> d8;
  const VF half = hn::Set(d, 0.5F);
  const VF most = hn::Set(d, 255.0F);
  using V32 = hn::Vec<decltype(d32)>;
  const auto code = [&](std::size_t k, std::size_t c, VF norm) HWY_ATTR {
    const VF root = hn::Sqrt(hn::Mul(hn::LoadU(d, sums + k * stride + c), norm));
    return hn::ConvertTo(d32, hn::Min(most, hn::Add(hn::Mul(hn::Set(d, scale), root), half)));
  };
  for (std::size_t c = 0; c < cells; c += hn::Lanes(d)) {
    const VF norm = hn::Div(hn::Set(d, 1.0F), hn::Sqrt(hn::Add(hn::LoadU(d, energy + c), hn::Set(d, noise2))));
    V32 low = code(0, c, norm);  // bytes of four orientations, the first one lowest
    low = hn::Or(low, hn::ShiftLeft<8>(code(1, c, norm)));
    low = hn::Or(low, hn::ShiftLeft<16>(code(2, c, norm)));
    low = hn::Or(low, hn::ShiftLeft<24>(code(3, c, norm)));
    V32 high = code(4, c, norm);
    high = hn::Or(high, hn::ShiftLeft<8>(code(5, c, norm)));
    high = hn::Or(high, hn::ShiftLeft<16>(code(6, c, norm)));
    high = hn::Or(high, hn::ShiftLeft<24>(code(7, c, norm)));
    HWY_ALIGN std::int32_t both[2 * kMaxLanes];
    hn::StoreInterleaved2(low, high, d32, both);
    std::uint8_t* const to = out + kGradientBins * c;
    const auto* const bytes = reinterpret_cast<const std::uint8_t*>(both);
    hn::StoreU(hn::Load(d8, bytes), d8, to);
    hn::StoreU(hn::LoadU(d8, bytes + hn::Lanes(d8)), d8, to + hn::Lanes(d8));
  }
}

#endif

}  // namespace victorious::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace victorious::kernels {

HWY_EXPORT(OrientGradientsTarget);
HWY_EXPORT(ReduceGradientsTarget);
HWY_EXPORT(SumGradientRowsTarget);
HWY_EXPORT(EncodeGradientsTarget);

void OrientGradients(const float* above, const float* here, const float* below, std::size_t width, std::size_t stride,
                     float* bins) {
  HWY_DYNAMIC_DISPATCH(OrientGradientsTarget)(above, here, below, width, stride, bins);
}

void ReduceGradients(const float* in, std::size_t columns, float* out) {
  HWY_DYNAMIC_DISPATCH(ReduceGradientsTarget)(in, columns, out);
}

void SumGradientRows(const std::array<const float*, kTriangleTaps>& rows, std::size_t count, float* out) {
  HWY_DYNAMIC_DISPATCH(SumGradientRowsTarget)(rows, count, out);
}

void EncodeGradients(const float* sums, std::size_t stride, const float* energy, std::size_t cells, float noise2,
                     float scale, std::uint8_t* out) {
  HWY_DYNAMIC_DISPATCH(EncodeGradientsTarget)(sums, stride, energy, cells, noise2, scale, out);
}

}  // namespace victorious::kernels
#endif  // HWY_ONCE

// OrientationHistogram on any vector width, through Highway.
#include "victorious/kernels/no_sve.h"
#include "victorious/kernels/orientation.h"
#include "victorious/kernels/orientation_bin.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "victorious/kernels/orientation_simd.cc"
#include <hwy/foreach_target.h>
// Highway requires this order: after foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace victorious::kernels::HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR

void OrientationHistogramTarget(const LevelView& level, int x, int y, const OrientationWindow& window,
                                std::span<std::int32_t, kOrientationBins> histogram) {
  OrientationHistogramRef(level, x, y, window, histogram);
}

#else

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kMaxLanes = 16;
using DF = hn::CappedTag<float, kMaxLanes>;
using D32 = hn::RebindToSigned<DF>;
using D16 = hn::Rebind<std::int16_t, DF>;
using VF = hn::Vec<DF>;

constexpr std::size_t kMaxSamples = OrientationWindow().weights.size();
static_assert(kOrientationStep == 2);

struct Gradients {
  HWY_ALIGN std::int16_t dx[kMaxSamples + kMaxLanes];
  HWY_ALIGN std::int16_t dy[kMaxSamples + kMaxLanes];
};

// The gradients of the window's samples, row by row without gaps.
void LoadGradients(const LevelView& level, int x, int y, int radius, Gradients& gradients) {
  const D16 d;
  const auto samples = static_cast<std::size_t>(2 * radius + 1);
  const std::ptrdiff_t stride = level.stride;
  std::size_t n = 0;
  for (int j = -radius; j <= radius; ++j, n += samples) {
    const std::int16_t* at = level.Row(y + kOrientationStep * j) + x - kOrientationStep * radius;
    // A row's last vector reaches beyond it; the next row overwrites that.
    for (std::size_t i = 0; i < samples; i += hn::Lanes(d), at += 2 * hn::Lanes(d)) {
      hn::Vec<D16> unused, left, right, above, below;
      hn::LoadInterleaved2(d, at - 1, left, unused);
      hn::LoadInterleaved2(d, at + 1, right, unused);
      hn::LoadInterleaved2(d, at - stride, above, unused);
      hn::LoadInterleaved2(d, at + stride, below, unused);
      hn::StoreU(hn::Sub(right, left), d, gradients.dx + n + i);
      hn::StoreU(hn::Sub(below, above), d, gradients.dy + n + i);
    }
  }
}

// DirectionOf of orientation_ref.cc.
HWY_INLINE hn::Vec<D32> DirectionsOf(VF dx, VF dy) {
  const DF d;
  const VF along_x = hn::Abs(dx);
  const VF along_y = hn::Abs(dy);
  const VF t = hn::Div(hn::Min(along_x, along_y), hn::Max(hn::Max(along_x, along_y), hn::Set(d, 1.0F)));
  const VF t2 = hn::Mul(t, t);
  VF sum = hn::Add(hn::Mul(hn::Set(d, kAtan7), t2), hn::Set(d, kAtan5));
  sum = hn::Add(hn::Mul(sum, t2), hn::Set(d, kAtan3));
  sum = hn::Add(hn::Mul(sum, t2), hn::Set(d, kAtan1));
  VF bin = hn::Mul(t, sum);
  bin = hn::IfThenElse(hn::Gt(along_y, along_x), hn::Sub(hn::Set(d, kQuarterTurn), bin), bin);
  bin = hn::IfThenElse(hn::Lt(dx, hn::Zero(d)), hn::Sub(hn::Set(d, 2 * kQuarterTurn), bin), bin);
  bin = hn::IfThenElse(hn::Lt(dy, hn::Zero(d)), hn::Sub(hn::Set(d, 4 * kQuarterTurn), bin), bin);
  return hn::ConvertTo(D32(), hn::Add(hn::Mul(bin, hn::Set(d, 256.0F)), hn::Set(d, 0.5F)));
}

void OrientationHistogramTarget(const LevelView& level, int x, int y, const OrientationWindow& window,
                                std::span<std::int32_t, kOrientationBins> histogram) {
  const DF d;
  const D32 d32;
  const D16 d16;
  const int reach = kOrientationStep * window.radius;
  if (x - reach < 1 || x + reach > level.width - 2 || y - reach < 1 || y + reach > level.height - 2) {
    OrientationHistogramRef(level, x, y, window, histogram);
    return;
  }
  Gradients gradients;
  LoadGradients(level, x, y, window.radius, gradients);
  const auto side = static_cast<std::size_t>(2 * window.radius + 1);
  HWY_ALIGN std::int32_t bins[kMaxSamples + kMaxLanes];
  HWY_ALIGN std::int32_t lower[kMaxSamples + kMaxLanes];  // parts of bins[i]
  HWY_ALIGN std::int32_t upper[kMaxSamples + kMaxLanes];  // parts of the next
  for (std::size_t i = 0; i < side * side; i += hn::Lanes(d)) {
    const VF dx = hn::ConvertTo(d, hn::PromoteTo(d32, hn::Load(d16, gradients.dx + i)));
    const VF dy = hn::ConvertTo(d, hn::PromoteTo(d32, hn::Load(d16, gradients.dy + i)));
    const VF length = hn::Sqrt(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)));
    const auto direction = DirectionsOf(dx, dy);
    const auto part = hn::ConvertTo(d32, hn::Mul(hn::LoadU(d, window.weights.data() + i), length));
    const auto share = hn::ShiftRight<8>(hn::Mul(part, hn::And(direction, hn::Set(d32, 255))));
    hn::Store(hn::ShiftRight<8>(direction), d32, bins + i);
    hn::Store(hn::Sub(part, share), d32, lower + i);
    hn::Store(share, d32, upper + i);
  }
  // Neighbouring samples often fall into one bin: several histograms let their additions overlap.
  std::int32_t sums[4][kOrientationBins + 2] = {};
  for (std::size_t i = 0; i < side * side; ++i) {
    std::int32_t* const sum = sums[i % 4] + bins[i];
    sum[0] += lower[i];
    sum[1] += upper[i];
  }
  for (std::size_t b = 0; b < kOrientationBins; ++b) histogram[b] = sums[0][b] + sums[1][b] + sums[2][b] + sums[3][b];
  for (const auto& one : sums) {  // a full turn is bin 0
    histogram[0] += one[kOrientationBins];
    histogram[1] += one[kOrientationBins + 1];
  }
}

#endif

}  // namespace victorious::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace victorious::kernels {

HWY_EXPORT(OrientationHistogramTarget);

void OrientationHistogram(const LevelView& level, int x, int y, const OrientationWindow& window,
                          std::span<std::int32_t, kOrientationBins> histogram) {
  HWY_DYNAMIC_DISPATCH(OrientationHistogramTarget)(level, x, y, window, histogram);
}

}  // namespace victorious::kernels
#endif  // HWY_ONCE

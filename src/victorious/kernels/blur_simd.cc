// The rows of blur.h on any vector width, through Highway: compiled once for each instruction set, chosen at run time.
#include "victorious/kernels/blur.h"
#include "victorious/kernels/no_sve.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "victorious/kernels/blur_simd.cc"
#include <hwy/foreach_target.h>
// Highway requires this order: after foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace victorious::kernels::HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR

void BlurColumnsTarget(const std::int16_t* const* rows, const BlurTaps& kernel, std::size_t width, std::int16_t* out) {
  BlurColumnsRef(rows, kernel, width, out);
}

void BlurRowTarget(const std::int16_t* in, const BlurTaps& kernel, std::size_t width, std::int16_t* out) {
  BlurRowRef(in, kernel, width, out);
}

void DoubleColumnsTarget(const std::uint8_t* const* rows, const DoublingTaps& kernel, std::size_t width,
                         std::int16_t* even, std::int16_t* odd) {
  DoubleColumnsRef(rows, kernel, width, even, odd);
}

void DoubleRowTarget(const std::int16_t* in, const DoublingTaps& kernel, std::size_t width, std::int16_t* out) {
  DoubleRowRef(in, kernel, width, out);
}

#else

namespace hn = hwy::HWY_NAMESPACE;

// Rows end at multiples of kRowMultiple pixels, so that whole vectors of this type cover them.
using D16 = hn::CappedTag<std::int16_t, kRowMultiple>;
using V16 = hn::Vec<D16>;

// Half of a sum, rounded up. Below, MulFixedPoint15 is MulRound of blur.h, except for the product of -32768 with
// itself, which taps cannot give.
HWY_INLINE V16 Halve(V16 sum) { return hn::ShiftRight<1>(hn::Add(sum, hn::Set(D16(), 1))); }

void BlurColumnsTarget(const std::int16_t* const* rows, const BlurTaps& kernel, std::size_t width, std::int16_t* out) {
  const D16 d;
  const int r = kernel.radius;
  for (std::size_t x = 0; x < width; x += 2 * hn::Lanes(d)) {
    // Two vectors at a time hide the latency of the products. Rows end at multiples of two vectors, or the second is
    // the first again.
    const std::size_t x2 = x + hn::Lanes(d) < width ? x + hn::Lanes(d) : x;
    V16 tap = hn::Set(d, kernel.taps[0]);
    V16 sum = hn::MulFixedPoint15(hn::LoadU(d, rows[r] + x), tap);
    V16 sum2 = hn::MulFixedPoint15(hn::LoadU(d, rows[r] + x2), tap);
    for (int k = 1; k <= r; ++k) {
      tap = hn::Set(d, kernel.taps[static_cast<std::size_t>(k)]);
      const std::int16_t* above = rows[r - k];
      const std::int16_t* below = rows[r + k];
      sum = hn::Add(sum, hn::MulFixedPoint15(hn::Add(hn::LoadU(d, above + x), hn::LoadU(d, below + x)), tap));
      sum2 = hn::Add(sum2, hn::MulFixedPoint15(hn::Add(hn::LoadU(d, above + x2), hn::LoadU(d, below + x2)), tap));
    }
    hn::StoreU(Halve(sum), d, out + x);
    hn::StoreU(Halve(sum2), d, out + x2);
  }
}

void BlurRowTarget(const std::int16_t* in, const BlurTaps& kernel, std::size_t width, std::int16_t* out) {
  const D16 d;
  for (std::size_t x = 0; x < width; x += 2 * hn::Lanes(d)) {
    const std::size_t x2 = x + hn::Lanes(d) < width ? x + hn::Lanes(d) : x;
    V16 tap = hn::Set(d, kernel.taps[0]);
    V16 sum = hn::MulFixedPoint15(hn::LoadU(d, in + x), tap);
    V16 sum2 = hn::MulFixedPoint15(hn::LoadU(d, in + x2), tap);
    for (int k = 1; k <= kernel.radius; ++k) {
      tap = hn::Set(d, kernel.taps[static_cast<std::size_t>(k)]);
      const std::int16_t* left = in - k;
      const std::int16_t* right = in + k;
      sum = hn::Add(sum, hn::MulFixedPoint15(hn::Add(hn::LoadU(d, left + x), hn::LoadU(d, right + x)), tap));
      sum2 = hn::Add(sum2, hn::MulFixedPoint15(hn::Add(hn::LoadU(d, left + x2), hn::LoadU(d, right + x2)), tap));
    }
    hn::StoreU(Halve(sum), d, out + x);
    hn::StoreU(Halve(sum2), d, out + x2);
  }
}

// 256 grey - 2 kLevelOffset, of as many pixels as a vector has lanes.
HWY_INLINE V16 LoadGrey(const std::uint8_t* grey) {
  const D16 d;
  const hn::Rebind<std::uint8_t, D16> d8;
  return hn::Sub(hn::ShiftLeft<8>(hn::PromoteTo(d, hn::LoadU(d8, grey))), hn::Set(d, 2 * kLevelOffset));
}

void DoubleColumnsTarget(const std::uint8_t* const* rows, const DoublingTaps& kernel, std::size_t width,
                         std::int16_t* even, std::int16_t* odd) {
  const D16 d;
  constexpr std::size_t kTaps = 2 * kDoublingReach;
  V16 taps[kTaps];
  for (std::size_t j = 0; j < kTaps; ++j) taps[j] = hn::Set(d, kernel.taps[j]);
  std::size_t x = 0;
  // The rows are those of an image, which may end at its last pixel: no whole vector reaches beyond.
  for (; x + hn::Lanes(d) <= width; x += hn::Lanes(d)) {
    V16 even_sum = hn::MulFixedPoint15(LoadGrey(rows[0] + x), taps[0]);
    V16 odd_sum = hn::MulFixedPoint15(LoadGrey(rows[kTaps] + x), taps[0]);
    for (std::size_t j = 1; j < kTaps; ++j) {
      const V16 grey = LoadGrey(rows[j] + x);
      even_sum = hn::Add(even_sum, hn::MulFixedPoint15(grey, taps[j]));
      odd_sum = hn::Add(odd_sum, hn::MulFixedPoint15(grey, taps[kTaps - j]));
    }
    hn::StoreU(Halve(even_sum), d, even + x);
    hn::StoreU(Halve(odd_sum), d, odd + x);
  }
  if (x == width) return;
  const std::uint8_t* rest[kTaps + 1];
  for (std::size_t j = 0; j <= kTaps; ++j) rest[j] = rows[j] + x;
  DoubleColumnsRef(rest, kernel, width - x, even + x, odd + x);
}

void DoubleRowTarget(const std::int16_t* in, const DoublingTaps& kernel, std::size_t width, std::int16_t* out) {
  const D16 d;
  constexpr std::size_t kTaps = 2 * kDoublingReach;
  V16 taps[kTaps];
  for (std::size_t j = 0; j < kTaps; ++j) taps[j] = hn::Set(d, kernel.taps[j]);
  const auto load = [&](const std::int16_t* at) {
    const V16 level = hn::LoadU(d, at);
    return hn::Add(level, level);
  };
  for (std::size_t x = 0; x < width; x += hn::Lanes(d)) {
    const std::int16_t* first = in + x - kDoublingReach;
    V16 even_sum = hn::MulFixedPoint15(load(first), taps[0]);
    V16 odd_sum = hn::MulFixedPoint15(load(first + kTaps), taps[0]);
    for (std::size_t j = 1; j < kTaps; ++j) {
      const V16 level = load(first + j);
      even_sum = hn::Add(even_sum, hn::MulFixedPoint15(level, taps[j]));
      odd_sum = hn::Add(odd_sum, hn::MulFixedPoint15(level, taps[kTaps - j]));
    }
    hn::StoreInterleaved2(Halve(even_sum), Halve(odd_sum), d, out + 2 * x);
  }
}

#endif

}  // namespace victorious::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace victorious::kernels {

HWY_EXPORT(BlurColumnsTarget);
HWY_EXPORT(BlurRowTarget);
HWY_EXPORT(DoubleColumnsTarget);
HWY_EXPORT(DoubleRowTarget);

void BlurColumns(const std::int16_t* const* rows, const BlurTaps& kernel, std::size_t width, std::int16_t* out) {
  HWY_DYNAMIC_DISPATCH(BlurColumnsTarget)(rows, kernel, width, out);
}

void BlurRow(const std::int16_t* in, const BlurTaps& kernel, std::size_t width, std::int16_t* out) {
  HWY_DYNAMIC_DISPATCH(BlurRowTarget)(in, kernel, width, out);
}

void DoubleColumns(const std::uint8_t* const* rows, const DoublingTaps& kernel, std::size_t width, std::int16_t* even,
                   std::int16_t* odd) {
  HWY_DYNAMIC_DISPATCH(DoubleColumnsTarget)(rows, kernel, width, even, odd);
}

void DoubleRow(const std::int16_t* in, const DoublingTaps& kernel, std::size_t width, std::int16_t* out) {
  HWY_DYNAMIC_DISPATCH(DoubleRowTarget)(in, kernel, width, out);
}

}  // namespace victorious::kernels
#endif  // HWY_ONCE

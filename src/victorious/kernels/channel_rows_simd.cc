// The loops of channels on any vector width, through Highway; the cells that fill no vector by the reference.
#include "victorious/kernels/channel_rows.h"
#include "victorious/kernels/no_sve.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "victorious/kernels/channel_rows_simd.cc"
#include <hwy/foreach_target.h>
// Highway requires this order: after foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace victorious::kernels::HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR

void AddPixelPairsTarget(const float* in, std::size_t count, float* out) { AddPixelPairsRef(in, count, out); }
void EncodeCellsTarget(const float* in, const float* gain, std::size_t count, std::uint8_t* out) {
  EncodeCellsRef(in, gain, count, out);
}

#else

namespace hn = hwy::HWY_NAMESPACE;

using DF = hn::ScalableTag<float>;

void AddPixelPairsTarget(const float* in, std::size_t count, float* out) {
  const DF d;
  std::size_t c = 0;
  for (; c + hn::Lanes(d) <= count; c += hn::Lanes(d)) {
    hn::Vec<DF> even, odd;
    hn::LoadInterleaved2(d, in + 2 * c, even, odd);
    hn::StoreU(hn::Add(hn::LoadU(d, out + c), hn::Add(even, odd)), d, out + c);
  }
  AddPixelPairsRef(in + 2 * c, count - c, out + c);
}

void EncodeCellsTarget(const float* in, const float* gain, std::size_t count, std::uint8_t* out) {
  const DF d;
  const hn::RebindToSigned<DF> d32;
  const hn::Rebind<std::uint8_t, DF> d8;
  const hn::Vec<DF> most = hn::Set(d, 255.0F);
  std::size_t c = 0;
  for (; c + hn::Lanes(d) <= count; c += hn::Lanes(d)) {
    const hn::Vec<DF> value = hn::Min(most, hn::Mul(hn::LoadU(d, in + c), hn::LoadU(d, gain + c)));
    hn::StoreU(hn::DemoteTo(d8, hn::ConvertTo(d32, value)), d8, out + c);
  }
  EncodeCellsRef(in + c, gain + c, count - c, out + c);
}

#endif

}  // namespace victorious::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace victorious::kernels {

HWY_EXPORT(AddPixelPairsTarget);
HWY_EXPORT(EncodeCellsTarget);

void AddPixelPairs(const float* in, std::size_t count, float* out) {
  HWY_DYNAMIC_DISPATCH(AddPixelPairsTarget)(in, count, out);
}

void EncodeCells(const float* in, const float* gain, std::size_t count, std::uint8_t* out) {
  HWY_DYNAMIC_DISPATCH(EncodeCellsTarget)(in, gain, count, out);
}

}  // namespace victorious::kernels
#endif  // HWY_ONCE

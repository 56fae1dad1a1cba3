// descriptor_distance.h on any vector width, through Highway.
#include "victorious/kernels/descriptor.h"
#include "victorious/kernels/descriptor_distance.h"
#include "victorious/kernels/no_sve.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "victorious/kernels/descriptor_distance_simd.cc"
#include <hwy/foreach_target.h>
// Highway requires this order: after foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace victorious::kernels::HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR

void ComputeDescriptorDistancesTarget(const std::uint8_t* query, std::span<const std::uint8_t* const> others,
                                      std::span<std::uint32_t> out) {
  ComputeDescriptorDistancesRef(query, others, out);
}

#else

namespace hn = hwy::HWY_NAMESPACE;

void ComputeDescriptorDistancesTarget(const std::uint8_t* query, std::span<const std::uint8_t* const> others,
                                      std::span<std::uint32_t> out) {
  const hn::CappedTag<std::int16_t, kDescriptorBytes> d16;
  const hn::Rebind<std::uint8_t, decltype(d16)> d8;
  const hn::RepartitionToWide<decltype(d16)> d32;
  for (std::size_t i = 0; i < others.size(); ++i) {
    auto sum = hn::Zero(d32);
    auto rest = hn::Zero(d32);
    for (std::size_t k = 0; k < kDescriptorBytes; k += hn::Lanes(d16)) {
      const auto difference =
          hn::Sub(hn::PromoteTo(d16, hn::LoadU(d8, query + k)), hn::PromoteTo(d16, hn::LoadU(d8, others[i] + k)));
      sum = hn::ReorderWidenMulAccumulate(d32, difference, difference, sum, rest);
    }
    out[i] = static_cast<std::uint32_t>(hn::GetLane(hn::SumOfLanes(d32, hn::Add(sum, rest))));
  }
}

#endif

}  // namespace victorious::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace victorious::kernels {

HWY_EXPORT(ComputeDescriptorDistancesTarget);

void ComputeDescriptorDistances(const std::uint8_t* query, std::span<const std::uint8_t* const> others,
                                std::span<std::uint32_t> out) {
  HWY_DYNAMIC_DISPATCH(ComputeDescriptorDistancesTarget)(query, others, out);
}

}  // namespace victorious::kernels
#endif  // HWY_ONCE

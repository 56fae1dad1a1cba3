// The definition of descriptor_distance.h.
#include "victorious/kernels/descriptor.h"
#include "victorious/kernels/descriptor_distance.h"

namespace victorious::kernels {

void ComputeDescriptorDistancesRef(const std::uint8_t* query, std::span<const std::uint8_t* const> others,
                                   std::span<std::uint32_t> out) {
  for (std::size_t i = 0; i < others.size(); ++i) {
    std::int32_t squared = 0;
    for (std::size_t k = 0; k < kDescriptorBytes; ++k) squared += (query[k] - others[i][k]) * (query[k] - others[i][k]);
    out[i] = static_cast<std::uint32_t>(squared);
  }
}

}  // namespace victorious::kernels

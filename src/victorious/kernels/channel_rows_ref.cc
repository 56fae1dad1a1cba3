// The reference implementation of the loops of channels: one cell at a time.
#include <algorithm>

#include "victorious/kernels/channel_rows.h"

namespace victorious::kernels {

void AddPixelPairsRef(const float* in, std::size_t count, float* out) {
  for (std::size_t c = 0; c < count; ++c) out[c] += in[2 * c] + in[2 * c + 1];
}

void EncodeCellsRef(const float* in, const float* gain, std::size_t count, std::uint8_t* out) {
  constexpr float kMost = 255;
  for (std::size_t c = 0; c < count; ++c) out[c] = static_cast<std::uint8_t>(std::min(kMost, in[c] * gain[c]));
}

}  // namespace victorious::kernels

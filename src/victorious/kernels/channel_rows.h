// kernels/, the loops of the channels of window detectors (category/channels/channel_planes.h) over a row of cells:
//   sums of two pixels, out[c] += in[2 c] + in[2 c + 1];
//   bytes, out[c] = floor(min(255, in[c] gain[c])).
// channel_rows_ref.cc is the reference; channel_rows_simd.cc (Highway, every instruction set) gives the same bits.
// C++20: no <expected> here.
#pragma once

#include <cstddef>
#include <cstdint>

namespace victorious::kernels {

/// @param in  2 count values
void AddPixelPairs(const float* in, std::size_t count, float* out);
void AddPixelPairsRef(const float* in, std::size_t count, float* out);

/// @param in, gain  at least 0
void EncodeCells(const float* in, const float* gain, std::size_t count, std::uint8_t* out);
void EncodeCellsRef(const float* in, const float* gain, std::size_t count, std::uint8_t* out);

}  // namespace victorious::kernels

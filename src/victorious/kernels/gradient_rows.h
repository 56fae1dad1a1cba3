// kernels/, the loops over pixels of gradient cells (search/shape/gradient_cells.h): the magnitude m of the gradient
// divided among the two nearest of 8 orientations of edges, and filtered by a triangle at every second pixel,
//   o_k(x) = m max(0, 1 - |8 a / pi - k|), k = 0 to 7, circular, a the angle of the gradient, 0 <= a < pi
//   h_k(c) = sum over j = -3 to 3 of (4 - |j|) / 16 o_k(2 c + j).
// gradient_rows_ref.cc is the reference; gradient_rows_simd.cc (Highway, every instruction set) differs by at most
// kMaxGradientError of the magnitude, and by one code: its angle is that of a polynomial, with the same bits on every
// instruction set.
// C++20: no <expected> here.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace victorious::kernels {

inline constexpr std::size_t kGradientBins = 8;
inline constexpr std::size_t kTriangleReach = 3;  ///< px
inline constexpr std::size_t kTriangleTaps = 2 * kTriangleReach + 1;
inline constexpr std::array<float, kTriangleTaps> kTriangle = {1 / 16.F, 2 / 16.F, 3 / 16.F, 4 / 16.F,
                                                               3 / 16.F, 2 / 16.F, 1 / 16.F};
inline constexpr std::size_t kGradientPadding = 48;  ///< elements that may be written after a row
inline constexpr std::size_t kGradientMargin = 8;    ///< elements that are read before a row
inline constexpr float kMaxGradientError = 1e-4F;

/// Of one row of an image.
/// @param above, here, below  `width` pixels, kGradientPadding readable ones after each, and of `here` one before
/// @param stride  between the rows of the orientations in `bins`, at least width + kGradientPadding
/// @param bins    bins[k stride + x] = o_k(x); up to kGradientPadding elements after each row are overwritten
void OrientGradients(const float* above, const float* here, const float* below, std::size_t width, std::size_t stride,
                     float* bins);
void OrientGradientsRef(const float* above, const float* here, const float* below, std::size_t width,
                        std::size_t stride, float* bins);

/// The triangle at every second pixel of a row: out[c] = h(c), 0 <= c < columns.
/// @param in   o(x); kGradientMargin elements before, and from 2 columns on kGradientPadding more, can be read
/// @param out  up to kGradientPadding elements after the row are overwritten
void ReduceGradients(const float* in, std::size_t columns, float* out);
void ReduceGradientsRef(const float* in, std::size_t columns, float* out);

/// The triangle across rows: out[i] = sum over t of kTriangle[t] rows[t][i], 0 <= i < count.
/// @param rows  kGradientPadding elements after each can be read; `out` as above
void SumGradientRows(const std::array<const float*, kTriangleTaps>& rows, std::size_t count, float* out);
void SumGradientRowsRef(const std::array<const float*, kTriangleTaps>& rows, std::size_t count, float* out);

/// Normalises a row of cells and rounds its values: with g(c) = 1 / sqrt(energy[c] + noise2),
///   out[8 c + k] = min(255, floor(scale sqrt(sums[k stride + c] g(c)) + 1/2)).
/// @param sums    at least 0; as kGradientPadding above, also of `energy`
/// @param out     8 cells; up to 8 kGradientPadding bytes after the row are overwritten
void EncodeGradients(const float* sums, std::size_t stride, const float* energy, std::size_t cells, float noise2,
                     float scale, std::uint8_t* out);
void EncodeGradientsRef(const float* sums, std::size_t stride, const float* energy, std::size_t cells, float noise2,
                        float scale, std::uint8_t* out);

}  // namespace victorious::kernels

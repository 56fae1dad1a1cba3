// features/, the scale space of SIFT: rows of a level from rows of the level below. Separable Gaussians in integers;
// the first level of an image doubles it on the way. Source: D. Lowe, "Distinctive image features from scale-invariant
// keypoints", IJCV 60(2), 2004, section 3.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "victorious/kernels/level.h"

namespace victorious::kernels {

inline constexpr int kMaxBlurRadius = 12;

/// A symmetric kernel: taps[0] + 2 (taps[1] + ... + taps[radius]) = 65536.
struct BlurTaps {
  int radius = 0;
  std::array<std::int16_t, kMaxBlurRadius + 1> taps{};
};

/// A Gaussian cut at 3 sigma, with the variance sigma_px^2 after the cut and rounding of the taps to 2^-16.
/// @param sigma_px  0.85 to 4
BlurTaps MakeBlurTaps(double sigma_px);

/// One row of a vertical pass. With MulRound(a, b) = (a b + 2^14) >> 15:
///   out[x] = (MulRound(rows[r][x], taps[0]) + sum_k MulRound(rows[r - k][x] + rows[r + k][x], taps[k]) + 1) >> 1
/// @param rows  2 * radius + 1 rows, each |pixel| <= kLevelOffset + 63, so that two fit into 16 bits, and readable to
/// PaddedWidth(width)
/// @param out   written up to PaddedWidth(width)
void BlurColumns(const std::int16_t* const* rows, const BlurTaps& kernel, std::size_t width, std::int16_t* out);
void BlurColumnsRef(const std::int16_t* const* rows, const BlurTaps& kernel, std::size_t width, std::int16_t* out);

/// One row of a horizontal pass; the same formula along x.
/// @param in  readable from in[-radius] to in[PaddedWidth(width) + radius - 1]
void BlurRow(const std::int16_t* in, const BlurTaps& kernel, std::size_t width, std::int16_t* out);
void BlurRowRef(const std::int16_t* in, const BlurTaps& kernel, std::size_t width, std::int16_t* out);

/// Bilinear doubling followed by a Gaussian, as one kernel on the pixels before doubling. The doubled pixel 2 i lies a
/// quarter of a pixel before pixel i and uses the pixels i - 3 to i + 2; 2 i + 1 lies a quarter behind it and mirrors
/// the taps. Their sum is 32768.
inline constexpr int kDoublingReach = 3;
struct DoublingTaps {
  std::array<std::int16_t, 2 * kDoublingReach> taps{};
};

/// @param sigma_px  of the Gaussian, in doubled pixels; at most 4/3, so that 3 sigma stay within 4 doubled pixels
DoublingTaps MakeDoublingTaps(double sigma_px);

/// The doubled rows 2 i and 2 i + 1 of an image, not yet doubled horizontally:
///   even[x] = (sum_j MulRound(256 grey_j[x] - 2 * kLevelOffset, taps[j]) + 1) >> 1 over rows[0..5];
///   odd[x]: the same over rows[1..6] with the taps reversed
/// @param rows  rows i - 3 to i + 3
void DoubleColumns(const std::uint8_t* const* rows, const DoublingTaps& kernel, std::size_t width, std::int16_t* even,
                   std::int16_t* odd);
void DoubleColumnsRef(const std::uint8_t* const* rows, const DoublingTaps& kernel, std::size_t width,
                      std::int16_t* even, std::int16_t* odd);

/// The doubled row, with the same taps on 2 in[x].
/// @param in   readable from in[-3] to in[PaddedWidth(width) + 2]
/// @param out  2 * width pixels; written up to 2 * PaddedWidth(width)
void DoubleRow(const std::int16_t* in, const DoublingTaps& kernel, std::size_t width, std::int16_t* out);
void DoubleRowRef(const std::int16_t* in, const DoublingTaps& kernel, std::size_t width, std::int16_t* out);

}  // namespace victorious::kernels

// kernels/, shortens SIFT descriptors to a quarter of their bytes, so that a comparison costs a quarter: the first pass
// of a proposal search (short_nearest.h), whose nearest few are compared again in full.
//
// A descriptor holds 4 x 4 cells of 8 orientation bins. A separable transform, the discrete cosine transform over the
// rows and the columns and the discrete Fourier transform over the bins, decorrelates them; the 32 coefficients of the
// highest variance over the views of CAD models hold 70 % of the variance (principal axes: 81 %). For a fixed basis,
// models and frames need no common training. Tables in integers, so that all arithmetic is exact: the same bits on
// every processor.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace victorious::kernels {

inline constexpr std::size_t kShortBytes = 32;  ///< of a shortened descriptor
inline constexpr int kShortCentre = 64;         ///< the value of a coefficient's mean

/// @param rows  kDescriptorBytes per descriptor
/// @return kShortBytes per descriptor, 0 to 127, in the same order
std::vector<std::uint8_t> Shorten(std::span<const std::uint8_t> rows);

/// The same less kShortCentre, for templates that are matched with many scenes.
std::vector<std::int8_t> ShortenToQueries(std::span<const std::uint8_t> rows);

}  // namespace victorious::kernels

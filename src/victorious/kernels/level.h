// The pixels of SIFT's scale space: 16-bit integers, so that every instruction set computes the same bits.
#pragma once

#include <cstddef>
#include <cstdint>

namespace victorious::kernels {

/// level = 128 * grey - 16320: symmetric about 0, so that the sum of two pixels fits 16 bits with a margin for
/// rounding.
inline constexpr int kLevelUnit = 128;
inline constexpr int kLevelOffset = 16320;

/// The storage of a row of pixels is a multiple of this; kernels may read and write up to there.
inline constexpr int kRowMultiple = 32;

constexpr std::size_t PaddedWidth(std::size_t width) {
  return (width + kRowMultiple - 1) / kRowMultiple * kRowMultiple;
}

/// One level of an octave. Non-owning. Kernels may read a row and kRowMultiple pixels past the last row.
struct LevelView {
  const std::int16_t* data = nullptr;
  std::ptrdiff_t stride = 0;  ///< elements from row to row
  int width = 0;
  int height = 0;

  [[nodiscard]] const std::int16_t* Row(int y) const { return data + y * stride; }
};

}  // namespace victorious::kernels

// For tests only: a geoid grid in the format .gtx.
#pragma once

#include <bit>
#include <cstdint>
#include <string>

namespace victorious::testing {

/// A global grid in steps of 90 degrees with the same height everywhere, in the bytes of a .gtx file.
/// @param undulation_m  height of the geoid above the ellipsoid
inline std::string ConstantGeoidGrid(float undulation_m) {
  std::string bytes;
  const auto append = [&](std::uint64_t value, int size) {
    for (int i = size - 1; i >= 0; --i) bytes += static_cast<char>(value >> (8 * i) & 0xFF);  // big-endian
  };
  constexpr std::uint32_t kRows = 3;
  constexpr std::uint32_t kColumns = 4;
  for (const double number : {-90.0, -180.0, 90.0, 90.0}) append(std::bit_cast<std::uint64_t>(number), 8);
  append(kRows, 4);
  append(kColumns, 4);
  for (std::uint32_t i = 0; i < kRows * kColumns; ++i) append(std::bit_cast<std::uint32_t>(undulation_m), 4);
  return bytes;
}

}  // namespace victorious::testing

// KLV packets as a producer writes them, for tests and fuzz seeds.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "victorious/input/telemetry/klv.h"
#include "victorious/input/telemetry/st0601.h"

namespace victorious::testing {

inline constexpr std::string_view kSt0601LabelBytes("\x06\x0E\x2B\x34\x02\x0B\x01\x01\x0E\x01\x03\x01\x01\0\0\0", 16);
inline constexpr std::string_view kEg0104LabelBytes("\x06\x0E\x2B\x34\x02\x01\x01\x01\x0E\x01\x01\x02\x01\x01\0\0", 16);

/// The number as `bytes` bytes, big-endian.
inline std::string BigEndian(std::uint64_t number, int bytes) {
  std::string text;
  for (int i = bytes - 1; i >= 0; --i) text += static_cast<char>(number >> (8 * i) & 0xFF);
  return text;
}

inline std::string BerLength(std::size_t length) {
  return length < 0x80 ? std::string(1, static_cast<char>(length)) : "\x82" + BigEndian(length, 2);
}

/// An ST 0601 packet of these items (number, value), with its checksum.
inline std::string St0601Packet(const std::vector<std::pair<int, std::string>>& items) {
  std::string value;
  for (const auto& [number, bytes] : items) {
    if (number >= 0x80) value += static_cast<char>(0x80 | number >> 7);
    value += static_cast<char>(number & 0x7F);
    value += BerLength(bytes.size()) + bytes;
  }
  constexpr std::size_t kChecksumItemSize = 4;
  const std::string packet =
      std::string(kSt0601LabelBytes) + BerLength(value.size() + kChecksumItemSize) + value + "\x01\x02";
  return packet + BigEndian(St0601Checksum(AsBytes(packet)), 2);
}

/// An ST 0601 packet of a camera at 42 degrees north and 71 west, 1000 m above the ellipsoid. The platform heads east,
/// the camera points 45 degrees down to its right, with a horizontal field of view of 30 degrees.
inline std::string CameraPacket(std::uint64_t time_us) {
  return St0601Packet({{2, BigEndian(time_us, 8)},
                       {5, BigEndian(16384, 2)},
                       {13, BigEndian(1002159035, 4)},
                       {14, BigEndian(static_cast<std::uint32_t>(-847062994), 4)},
                       {16, BigEndian(10923, 2)},
                       {18, BigEndian(1073741824, 4)},
                       {19, BigEndian(static_cast<std::uint32_t>(-536870912), 4)},
                       {20, BigEndian(0, 4)},
                       {75, BigEndian(6257, 2)},
                       {90, BigEndian(0, 4)},
                       {91, BigEndian(0, 4)}});
}

}  // namespace victorious::testing

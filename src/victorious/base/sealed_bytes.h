// The header of model files: a magic number, a format version, and the size and checksum of what follows, the payload.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace victorious {

using FileMagic = std::array<std::uint8_t, 8>;

/// As the files have it: little-endian, without padding.
struct SealedHeader {
  FileMagic magic{};
  std::uint32_t version = 0;
  std::uint32_t reserved = 0;
  std::uint64_t payload_size = 0;
  std::uint64_t payload_checksum = 0;
};
static_assert(sizeof(SealedHeader) == 32);

/// The payload behind its header.
[[nodiscard]] std::vector<std::byte> Seal(const FileMagic& magic, std::uint32_t version,
                                          std::span<const std::byte> payload);

/// True of bytes that begin with a magic number, damaged or not.
[[nodiscard]] bool HasMagic(std::span<const std::byte> bytes, const FileMagic& magic);

/// The header of any bytes; std::nullopt if they end in it.
[[nodiscard]] std::optional<SealedHeader> ReadSealedHeader(std::span<const std::byte> bytes);

/// What is behind the header. @param bytes  at least as long as it
[[nodiscard]] inline std::span<const std::byte> PayloadOf(std::span<const std::byte> bytes) {
  return bytes.subspan(sizeof(SealedHeader));
}

/// What is wrong with a payload, for a message; null: nothing.
[[nodiscard]] const char* FaultOfPayload(const SealedHeader& header, std::span<const std::byte> payload);

}  // namespace victorious

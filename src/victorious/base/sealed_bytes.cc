#include "victorious/base/sealed_bytes.h"

#include <cstring>

#include "victorious/base/file.h"

namespace victorious {

std::vector<std::byte> Seal(const FileMagic& magic, std::uint32_t version, std::span<const std::byte> payload) {
  const SealedHeader header{
      .magic = magic, .version = version, .payload_size = payload.size(), .payload_checksum = Checksum(payload)};
  const auto head = std::as_bytes(std::span(&header, 1));
  std::vector<std::byte> bytes(head.begin(), head.end());
  bytes.insert(bytes.end(), payload.begin(), payload.end());
  return bytes;
}

bool HasMagic(std::span<const std::byte> bytes, const FileMagic& magic) {
  return bytes.size() >= magic.size() && std::memcmp(bytes.data(), magic.data(), magic.size()) == 0;
}

std::optional<SealedHeader> ReadSealedHeader(std::span<const std::byte> bytes) {
  SealedHeader header;
  if (bytes.size() < sizeof(header)) return std::nullopt;
  std::memcpy(&header, bytes.data(), sizeof(header));
  return header;
}

const char* FaultOfPayload(const SealedHeader& header, std::span<const std::byte> payload) {
  if (payload.size() != header.payload_size) return "its size is wrong";
  return Checksum(payload) == header.payload_checksum ? nullptr : "its checksum is wrong";
}

}  // namespace victorious

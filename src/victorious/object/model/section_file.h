// A container of checksummed sections, used for model files. docs/formats/model.md describes every byte.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "victorious/base/error.h"

namespace victorious {

/// Alignment of sections in bytes, so that arrays can be used in place in the mapped file.
inline constexpr std::size_t kSectionAlignment = 64;

struct Section {
  std::string_view tag;  ///< 1 to 8 ASCII characters
  std::span<const std::byte> bytes;
};

struct SectionFile {
  std::vector<Section> sections;  ///< in file order; they point into the parsed bytes
  std::uint64_t content = 0;      ///< checksum of all tags, sizes and contents
};

/// Returns the bytes of the file: header, table, sections.
std::vector<std::byte> EncodeSections(std::span<const Section> sections);

/// Validates sizes, bounds, alignment, checksums and the uniqueness of tags. Never reads outside `bytes`. Errors: as of
/// ParseModel; the message does not name the file.
[[nodiscard]] Expected<SectionFile> ParseSections(std::span<const std::byte> bytes);

}  // namespace victorious

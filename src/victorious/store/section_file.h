// A file of checksummed sections: what a model is packed in. docs/formats/model.md describes every byte.
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

/// Sections begin at multiples of this, so that arrays can be used where they lie in the mapping.
inline constexpr std::size_t kSectionAlignment = 64;

struct Section {
  std::string_view tag;  ///< 1 to 8 ASCII characters
  std::span<const std::byte> bytes;
};

struct SectionFile {
  std::vector<Section> sections;  ///< in the file's order; they point into the bytes parsed
  std::uint64_t content = 0;      ///< checksum of all tags, sizes and contents
};

/// The file's bytes: header, table, sections.
std::vector<std::byte> EncodeSections(std::span<const Section> sections);

/// Checks everything: sizes, bounds, alignment, checksums; tags occur once. Never reads outside `bytes`. Errors as
/// ParseModel's, without the file's name.
Expected<SectionFile> ParseSections(std::span<const std::byte> bytes);

}  // namespace victorious

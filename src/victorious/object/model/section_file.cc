#include "victorious/object/model/section_file.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include <fmt/format.h>

#include "victorious/base/check.h"
#include "victorious/base/file.h"

namespace victorious {
namespace {

// The structs below are stored with their memory layout.
static_assert(std::endian::native == std::endian::little);

// As in PNG: the first byte is not ASCII, and the line ends reveal a transfer in text mode.
constexpr std::array<char, 8> kMagic = {'\x8A', 'V', 'M', 'D', 'L', '\r', '\n', '\x1A'};
constexpr std::uint32_t kVersion = 2;
constexpr std::uint32_t kOldestVersion = 2;  // the options of version 1 have other names
constexpr std::uint32_t kMaxSections = 64;
constexpr std::size_t kMaxTag = 8;

struct Header {
  std::array<char, 8> magic = kMagic;
  std::uint32_t version = kVersion;
  std::uint32_t section_count = 0;
  std::uint64_t file_size = 0;
  std::uint64_t table_checksum = 0;
  std::array<std::uint64_t, 3> reserved = {};
  std::uint64_t header_checksum = 0;  // of the 56 bytes before it
};
static_assert(sizeof(Header) == 64);

struct TableEntry {
  std::array<char, kMaxTag> tag = {};  // padded with zeros
  std::uint64_t offset = 0;
  std::uint64_t size = 0;
  std::uint64_t checksum = 0;
};
static_assert(sizeof(TableEntry) == 32);

std::size_t AlignUp(std::size_t offset) {
  return (offset + kSectionAlignment - 1) / kSectionAlignment * kSectionAlignment;
}

std::uint64_t HeaderChecksum(const Header& header) {
  return Checksum(std::as_bytes(std::span(&header, 1)).first(offsetof(Header, header_checksum)));
}

std::string_view ReadTag(std::span<const std::byte> entry) {
  const std::string_view padded(reinterpret_cast<const char*>(entry.data()), kMaxTag);
  return padded.substr(0, padded.find('\0'));
}

Expected<Header> ParseHeader(std::span<const std::byte> bytes) {
  Header header;
  if (bytes.size() < sizeof(Header)) {
    const std::size_t common = std::min(bytes.size(), kMagic.size());
    const bool has_valid_prefix = common > 0 && std::memcmp(bytes.data(), kMagic.data(), common) == 0;
    if (!has_valid_prefix) return Fail(ErrorCode::kDataLoss, "not a model file");
    return Fail(ErrorCode::kDataLoss, fmt::format("cut off after {} bytes", bytes.size()));
  }
  std::memcpy(&header, bytes.data(), sizeof(Header));
  if (header.magic != kMagic) return Fail(ErrorCode::kDataLoss, "not a model file");
  if (header.header_checksum != HeaderChecksum(header)) {
    return Fail(ErrorCode::kDataLoss, "damaged (wrong checksum of the header)");
  }
  if (header.version > kVersion) {
    return Fail(ErrorCode::kUnsupported,
                fmt::format("written by a newer version (format {}; this program reads up to {}), which can read it",
                            header.version, kVersion));
  }
  if (header.version < kOldestVersion) {
    return Fail(ErrorCode::kUnsupported, fmt::format("made by an older version (format {}; this program reads from {})",
                                                     header.version, kOldestVersion));
  }
  if (header.section_count > kMaxSections) {
    return Fail(ErrorCode::kDataLoss,
                fmt::format("damaged (format {}, {} sections)", header.version, header.section_count));
  }
  if (header.file_size != bytes.size()) {
    return Fail(ErrorCode::kDataLoss,
                fmt::format("{} ({} bytes, expected {})", bytes.size() < header.file_size ? "cut off" : "damaged",
                            bytes.size(), header.file_size));
  }
  return header;
}

Expected<Section> ParseEntry(std::span<const std::byte> bytes, std::span<const std::byte> entry_bytes,
                             std::size_t table_end) {
  TableEntry entry;
  std::memcpy(&entry, entry_bytes.data(), sizeof(TableEntry));
  const std::string_view tag = ReadTag(entry_bytes);
  const bool inside = entry.offset >= table_end && entry.offset <= bytes.size() &&
                      entry.size <= bytes.size() - entry.offset && entry.offset % kSectionAlignment == 0;
  if (!inside) return Fail(ErrorCode::kDataLoss, "damaged (a section is outside the file)");
  const std::span<const std::byte> content = bytes.subspan(entry.offset, entry.size);
  if (Checksum(content) != entry.checksum) {
    return Fail(ErrorCode::kDataLoss, "damaged (wrong checksum of a section)");
  }
  return Section{tag, content};
}

}  // namespace

std::vector<std::byte> EncodeSections(std::span<const Section> sections) {
  VICTORIOUS_CHECK(sections.size() <= kMaxSections);
  std::vector<TableEntry> table(sections.size());
  std::size_t end = sizeof(Header) + table.size() * sizeof(TableEntry);
  for (std::size_t i = 0; i < sections.size(); ++i) {
    VICTORIOUS_CHECK(!sections[i].tag.empty() && sections[i].tag.size() <= kMaxTag);
    std::ranges::copy(sections[i].tag, table[i].tag.begin());
    table[i].offset = AlignUp(end);
    table[i].size = sections[i].bytes.size();
    table[i].checksum = Checksum(sections[i].bytes);
    end = table[i].offset + table[i].size;
  }
  Header header;
  header.section_count = static_cast<std::uint32_t>(sections.size());
  header.file_size = end;
  header.table_checksum = Checksum(std::as_bytes(std::span(table)));
  header.header_checksum = HeaderChecksum(header);

  std::vector<std::byte> bytes(end);
  std::memcpy(bytes.data(), &header, sizeof(Header));
  std::ranges::copy(std::as_bytes(std::span(table)), bytes.begin() + sizeof(Header));
  for (std::size_t i = 0; i < sections.size(); ++i) {
    std::ranges::copy(sections[i].bytes, bytes.begin() + static_cast<std::ptrdiff_t>(table[i].offset));
  }
  return bytes;
}

Expected<SectionFile> ParseSections(std::span<const std::byte> bytes) {
  VICTORIOUS_ASSIGN_OR_RETURN(const Header header, ParseHeader(bytes));
  const std::size_t table_size = header.section_count * sizeof(TableEntry);
  if (table_size > bytes.size() - sizeof(Header)) {
    return Fail(ErrorCode::kDataLoss, "damaged (the section table does not fit)");
  }
  const std::span<const std::byte> table = bytes.subspan(sizeof(Header), table_size);
  if (Checksum(table) != header.table_checksum) {
    return Fail(ErrorCode::kDataLoss, "damaged (wrong checksum of the section table)");
  }
  // The table contains every section's tag, size and checksum, so its checksum identifies the whole content.
  SectionFile file{.sections = {}, .content = header.table_checksum};
  for (std::size_t i = 0; i < header.section_count; ++i) {
    const auto entry = table.subspan(i * sizeof(TableEntry), sizeof(TableEntry));
    VICTORIOUS_ASSIGN_OR_RETURN(const Section section, ParseEntry(bytes, entry, sizeof(Header) + table_size));
    if (std::ranges::find(file.sections, section.tag, &Section::tag) != file.sections.end()) {
      return Fail(ErrorCode::kDataLoss, "damaged (a section occurs twice)");
    }
    file.sections.push_back(section);
  }
  return file;
}

}  // namespace victorious

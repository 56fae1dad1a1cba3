// Fuzzes the reader of PMTiles files: it reads their header and metadata.
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "testing/data.h"
#include "tests/fuzz/fuzz_target.h"
#include "victorious/apps/serve/base_map.h"
#include "victorious/base/check.h"
#include "victorious/base/file.h"

namespace {

// A header (127 bytes, little-endian) of version 3, and metadata behind it.
std::string PmTiles(std::string_view metadata, char type, char compression) {
  std::string bytes = "PMTiles\x03";
  bytes.resize(127, '\0');
  const auto put = [&](std::size_t at, std::uint64_t value) {
    for (std::size_t i = 0; i < 8; ++i) bytes[at + i] = static_cast<char>(value >> (8 * i) & 0xFF);
  };
  put(24, 127);
  put(32, metadata.size());
  bytes[97] = compression;
  bytes[99] = type;
  bytes[101] = 14;
  return bytes + std::string(metadata);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const victorious::testing::ScratchFolder folder;
  const std::string path = (folder.path() / "map.pmtiles").string();
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  VICTORIOUS_CHECK(victorious::WriteFileAtomically(path, bytes).has_value());
  const auto map = victorious::ReadBaseMap(path, "");
  if (map) {
    VICTORIOUS_CHECK(!map->IsNone() && map->max_zoom >= 0);
  } else {
    VICTORIOUS_CHECK(!map.error().message.empty() && map.error().message.find('\n') == std::string::npos);
  }
  return 0;
}

std::vector<std::string> FuzzSeeds() {
  return {"", PmTiles(R"({"attribution": "&copy; a <b>map</b>"})", 2, 1), PmTiles("{}", 1, 1),
          PmTiles("\x1f\x8b\x08", 1, 2), PmTiles("[", 3, 1)};
}

#include "victorious/base/foreign_file.h"

#include <array>
#include <string_view>

namespace victorious {
namespace {

struct Kind {
  std::string_view start;  // of the file
  std::string_view description;
};

constexpr auto kKinds = std::to_array<Kind>({
    {"ISO-10303-21;", "a STEP file: CAD solids are not read: export it as glTF"},
    {"; FBX", "an FBX file, which is not read: export it as glTF"},
    {"Kaydara FBX Binary", "an FBX file, which is not read: export it as glTF"},
    {"OFF\n", "an OFF file, which is not read: export it as glTF, OBJ or PLY"},
    {"OFF\r", "an OFF file, which is not read: export it as glTF, OBJ or PLY"},
    {"COFF", "an OFF file, which is not read: export it as glTF, OBJ or PLY"},
    {"LASF", "a point cloud (LAS), which has no faces: make a mesh of it first"},
    {"BLENDER", "a Blender file, which is not read: export it as glTF"},
    {"PXR-USDC", "a USD file, which is not read: export it as glTF"},
    {"#usda", "a USD file, which is not read: export it as glTF"},
});

// The name of the first file in a ZIP archive (its local file header, APPNOTE 4.3.7).
std::string_view FirstName(std::string_view archive) {
  constexpr std::size_t kLengthAt = 26;
  constexpr std::size_t kNameAt = 30;
  if (archive.size() < kNameAt) return {};
  const std::size_t length = static_cast<unsigned char>(archive[kLengthAt]) +
                             256 * static_cast<std::size_t>(static_cast<unsigned char>(archive[kLengthAt + 1]));
  return archive.substr(kNameAt, length);
}

}  // namespace

std::optional<std::string> DescribeForeignFile(std::span<const std::byte> bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  for (const Kind& kind : kKinds) {
    if (text.starts_with(kind.start)) return std::string(kind.description);
  }
  if (!text.starts_with("PK\x03\x04")) return std::nullopt;
  const std::string_view first = FirstName(text);
  if (first.ends_with(".usda") || first.ends_with(".usdc") || first.ends_with(".usd"))
    return "a USDZ file, which is not read: export it as glTF";
  if (text.find("3D/3dmodel.model") != std::string_view::npos)
    return "a 3MF file, which is not read: export it as glTF, OBJ or PLY";
  return "an archive (ZIP): unpack it first";
}

}  // namespace victorious

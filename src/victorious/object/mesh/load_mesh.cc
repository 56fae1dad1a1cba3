#include "victorious/object/mesh/load_mesh.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "victorious/base/file.h"
#include "victorious/base/isolated_process.h"
#include "victorious/base/text.h"
#include "victorious/object/mesh/assimp_import.h"
#include "victorious/object/mesh/import_request.h"
#include "victorious/object/mesh/mesh_bytes.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;

// Imports it in a process of its own.
Expected<std::string> AskDecoder(std::string_view request, const std::optional<fs::path>& folder,
                                 std::size_t file_bytes, const LoadMeshOptions& options) {
  constexpr unsigned kPatience = 6;  // of a machine with other work
  const unsigned processor_s = kMaxImportSeconds + static_cast<unsigned>(file_bytes >> 22);
  VICTORIOUS_ASSIGN_OR_RETURN(IsolatedProcess decoder, IsolatedProcess::Start(kMeshImport, {}));
  IsolationLimits limits{.memory_bytes = kMaxImportBytes, .processor_s = processor_s};
  if (folder) limits.readable.push_back(folder->empty() ? fs::path(".") : *folder);
  decoder.Confine(std::move(limits));
  return decoder.Ask(request, {.patience = std::chrono::seconds(kPatience * processor_s),
                               .max_answer_bytes = kMaxImportBytes,
                               .cancel = options.cancel});
}

Expected<LoadedMesh> Load(std::span<const std::byte> bytes, const std::string& name, std::optional<fs::path> folder,
                          const LoadMeshOptions& options) {
  const auto format = CadFormatFromName(name);
  if (!format) {
    return Fail(ErrorCode::kUnsupported, fmt::format("{}: not a CAD file ({})", name, kCadExtensions));
  }
  if (options.length_m && !(*options.length_m > 0 && std::isfinite(*options.length_m))) {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("length {} m: must be above 0", *options.length_m));
  }
  const ImportRequest request{
      .name = fs::path(name).filename().string(), .folder = std::move(folder), .format = *format, .options = options};
  auto result = AskDecoder(PackImportRequest(request, bytes), request.folder, bytes.size(), options);
  if (!result) return std::unexpected(std::move(result).error().WithContext(name));
  auto loaded = MeshFromBytes(*result);
  if (!loaded) return std::unexpected(std::move(loaded).error().WithContext(name));
  loaded->length_m = ObjectLength(BoundingBox(loaded->mesh).sizes(), *format);
  return loaded;
}

}  // namespace

bool IsCadFile(const fs::path& path) { return CadFormatFromName(path.string()).has_value(); }

Expected<Axis> ParseAxis(std::string_view text) {
  std::string name = LowerCase(text);
  if (name.size() == 1) name.insert(0, "+");
  const auto found = std::ranges::find(kAxisNames, name);
  if (found == kAxisNames.end()) {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("axis '{}': must be x, y, z, -x, -y or -z", text));
  }
  return static_cast<Axis>(found - kAxisNames.begin());
}

Expected<LoadedMesh> LoadMesh(const fs::path& path, const LoadMeshOptions& options) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string bytes, ReadFile(path, kMaxCadBytes));
  return Load(std::as_bytes(std::span(bytes)), path.string(), path.parent_path(), options);
}

Expected<LoadedMesh> DecodeMesh(std::span<const std::byte> bytes, const std::string& name,
                                const LoadMeshOptions& options) {
  return Load(bytes, name, std::nullopt, options);
}

}  // namespace victorious

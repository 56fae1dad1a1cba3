// Private to mesh/: converts an assimp scene into one Mesh. Call it only in an isolated process
// (base/isolated_process.h): assimp may crash on hostile files.
#pragma once

#include <optional>
#include <string_view>

#include "victorious/base/error.h"
#include "victorious/object/mesh/cad_folder.h"
#include "victorious/object/mesh/load_mesh.h"

namespace victorious {

enum class CadFormat { kGltf, kObj, kAc3d, kCollada, k3ds, kPly, kStl };

/// The format by file extension, case-insensitive; std::nullopt for any other extension.
[[nodiscard]] std::optional<CadFormat> CadFormatFromName(std::string_view name);

struct ImportedMesh {
  LoadedMesh loaded;       ///< in the file's own frame and unit; missing normals are zero vectors
  Axis up = Axis::kPlusY;  ///< the up axis of that frame
};

/// Imports the CAD file of `folder`. May throw std::bad_alloc. Errors: kDataLoss, kUnsupported.
[[nodiscard]] Expected<ImportedMesh> ImportMesh(const CadFolder& folder, CadFormat format);

}  // namespace victorious

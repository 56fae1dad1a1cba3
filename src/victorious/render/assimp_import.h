// Private to render/: assimp's scene as one mesh. Runs only where a crash does no harm (isolated.h).
#pragma once

#include <optional>
#include <string_view>

#include "victorious/base/error.h"
#include "victorious/render/cad_folder.h"
#include "victorious/render/load_mesh.h"

namespace victorious {

enum class CadFormat { kGltf, kObj, kAc3d, kCollada, k3ds, kPly, kStl };

/// By the name's ending, in either case.
[[nodiscard]] std::optional<CadFormat> CadFormatOf(std::string_view name);

struct ImportedMesh {
  LoadedMesh loaded;       ///< in the file's own frame and unit; a missing normal is zero
  Axis up = Axis::kPlusY;  ///< of that frame
};

/// May throw std::bad_alloc. Error: kDataLoss, kUnsupported.
Expected<ImportedMesh> ImportMesh(const CadFolder& folder, CadFormat format);

}  // namespace victorious

// Private to mesh/: serialises a loaded mesh, to pass it from the isolated import process to the parent
// (base/isolated_process.h).
#pragma once

#include <string>
#include <string_view>

#include "victorious/object/mesh/load_mesh.h"

namespace victorious {

std::string BytesFromMesh(const LoadedMesh& loaded);

/// The inverse of BytesFromMesh(). Checks sizes and indices, because a hostile CAD file may have taken control of the
/// writing process. Error: kDataLoss.
[[nodiscard]] Expected<LoadedMesh> MeshFromBytes(std::string_view bytes);

}  // namespace victorious

// Private to render/: a loaded mesh as bytes, to pass it from one process to another of the same program.
#pragma once

#include <string>
#include <string_view>

#include "victorious/render/load_mesh.h"

namespace victorious {

std::string BytesFromMesh(const LoadedMesh& loaded);

/// Checks sizes and indices: the writer has read hostile bytes. Error: kDataLoss.
Expected<LoadedMesh> MeshFromBytes(std::string_view bytes);

}  // namespace victorious

// Private to mesh/: what the importer does not read of glTF 2.0, expressed by what it reads: integer attributes, skins,
// morph targets, instances, texture coordinates chosen by a texture transform.
#pragma once

#include <string>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/mesh/gltf_file.h"

namespace victorious {

/// Returns a warning for each texture that is left out.
/// Error: kUnsupported for an extension that the file requires and that is not read.
[[nodiscard]] Expected<std::vector<std::string>> SimplifyGltf(GltfFile& file);

}  // namespace victorious

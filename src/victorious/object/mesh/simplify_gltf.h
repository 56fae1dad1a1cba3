// Private to mesh/: what the importer does not read of glTF 2.0, expressed by what it reads: integer attributes, skins,
// morph targets, instances, texture coordinates chosen by a texture transform.
#pragma once

#include <string>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/object/mesh/gltf_file.h"

namespace victorious {

/// Coordinates of this size and above are of a map, not of a vehicle: floats of 32 bits are 1 mm apart there, and more.
inline constexpr double kMapCoordinate = 8192;

/// Returns a warning for each texture that is left out.
/// Error: kUnsupported for an extension that the file requires and that is not read.
[[nodiscard]] Expected<std::vector<std::string>> SimplifyGltf(GltfFile& file);

}  // namespace victorious

// Private to mesh/: a CAD file as the importer reads it right. What it is known to misread is rewritten first; a file
// without such a thing stays as it is, byte for byte.
//
//   glTF  integer attributes, skins, morph targets, instances, coordinates chosen by a texture transform
//   OBJ   a byte order mark; coordinates of a map, which 32 bits would round; a missing material file is said
//   PLY   data that begin with a line feed; colours named diffuse_red, …; a point cloud is refused
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/object/mesh/assimp_import.h"
#include "victorious/object/mesh/cad_folder.h"

namespace victorious {

struct ReadableFile {
  std::optional<std::string> rewritten;  ///< std::nullopt: the file as it is
  std::vector<std::string> warnings;     ///< what is left out, one line each
};

/// Errors: kUnsupported for what cannot be read as intended, kDataLoss for a damaged header.
[[nodiscard]] Expected<ReadableFile> MakeReadable(const CadFolder& folder, CadFormat format);

}  // namespace victorious

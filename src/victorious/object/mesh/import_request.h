// Of mesh/ and the program victorious-decoder: what an import is asked for, and the import itself.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <Eigen/Core>

#include "victorious/base/error.h"
#include "victorious/object/mesh/assimp_import.h"
#include "victorious/object/mesh/load_mesh.h"

namespace victorious {

/// The name of ImportMeshRequest in the program (base/isolated_main.h).
inline constexpr std::string_view kMeshImport = "mesh";

/// By the value of Axis.
inline constexpr std::array<std::string_view, 6> kAxisNames = {"+x", "-x", "+y", "-y", "+z", "-z"};

struct ImportRequest {
  std::string name;                             ///< of the file, without a folder
  std::optional<std::filesystem::path> folder;  ///< that of the file; std::nullopt: it may not read other files
  CadFormat format = CadFormat::kGltf;
  LoadMeshOptions options;
};

/// @param file  content of the CAD file
[[nodiscard]] std::string PackImportRequest(const ImportRequest& request, std::span<const std::byte> file);

/// Imports a packed request, and packs the mesh (mesh_bytes.h). Call it in an isolated process only: the importer is
/// not hardened against hostile files. Errors: those of LoadMesh, without the file's name. May throw std::bad_alloc.
[[nodiscard]] Expected<std::string> ImportMeshRequest(std::string_view request);

/// LoadedMesh::length_m for a bounding box of this size.
[[nodiscard]] double ObjectLength(const Eigen::Vector3d& size, CadFormat format);

}  // namespace victorious

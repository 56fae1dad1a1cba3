// Reads a CAD file into a Mesh: glTF and GLB, OBJ (with its mtl), AC3D, COLLADA, 3DS, PLY, STL.
//
// CAD files are untrusted input, and the import library (assimp) is not hardened against hostile files. It therefore
// runs in a process of its own, with limits and in a sandbox (base/isolated_process.h): a file that crashes it gives a
// one-line error, like any other damage. See docs/adr/0033-decoders.md. Only files in the CAD file's own folder, and
// below it, are read.
//
// Axes in the file, which are rotated into the model frame of mesh.h:
//   glTF, OBJ, AC3D   Y up, front +Z
//   COLLADA           up as the file specifies; front +Z if Y is up, -Y if Z is up, +Z if X is up
//   3DS, PLY, STL     Z up, front -Y
//
// glTF colours are linear. Material and vertex colours of the other formats are interpreted as sRGB, as their editors
// show them. The other formats do not specify sides: their triangles are double-sided. Their textures with an alpha
// channel are masks (AlphaMode::kMask); their materials with an opacity below 1 are blended.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/types/mesh.h"

namespace victorious {

/// A signed axis of the CAD file's own frame.
enum class Axis { kPlusX, kMinusX, kPlusY, kMinusY, kPlusZ, kMinusZ };

/// Parses "x", "+x", "-x", …, case-insensitive. Error: kInvalidArgument.
[[nodiscard]] Expected<Axis> ParseAxis(std::string_view text);

/// For messages.
inline constexpr std::string_view kCadExtensions = ".gltf, .glb, .obj, .ac, .dae, .3ds, .ply or .stl";

/// True if the file extension is one of these, case-insensitive.
bool IsCadFile(const std::filesystem::path& path);

struct LoadMeshOptions {
  std::optional<Axis> up;          ///< up axis in the file; default: that of the format
  std::optional<Axis> front;       ///< front axis in the file; default: +Z, or -Y if Z is up
  std::optional<double> length_m;  ///< the mesh is scaled to this length (LoadedMesh::length_m); default: the unit of
                                   ///< the file is the metre (COLLADA specifies its own unit)
  const CancelToken* cancel = nullptr;  ///< ends the import
};

/// Limits of the reader; files beyond them are refused (kUnsupported).
inline constexpr std::uint64_t kMaxCadBytes = std::uint64_t{256} << 20;  ///< of the file, and of each file it refers to
inline constexpr std::size_t kMaxTriangles = 4'000'000;
inline constexpr int kMaxTextureSide = 8192;                              ///< px
inline constexpr std::uint64_t kMaxImportBytes = std::uint64_t{3} << 30;  ///< memory of the import process
inline constexpr unsigned kMaxImportSeconds = 10;  ///< CPU time; plus 1 s for each 4 MiB of the file

struct LoadedMesh {
  Mesh mesh;                          ///< has at least one triangle
  double length_m = 0;                ///< glTF: extent along the front axis; other formats: longest side of the box
  std::vector<std::string> warnings;  ///< one line for each missing or damaged part that was skipped
};

/// Reads a CAD file. A partly damaged file is read as far as possible, with warnings: a missing texture is replaced by
/// the material's colour, a triangle with a non-finite or missing vertex is skipped.
/// Errors: kNotFound; kInvalidArgument (options); kDataLoss (no drawable triangle); kUnsupported (unknown format, or
/// beyond the limits above, e.g. 3 GiB of memory, or the CPU time: 10 s plus 1 s for each 4 MiB, or six times that on
/// the clock); kCancelled; kInternal if the process cannot be started.
[[nodiscard]] Expected<LoadedMesh> LoadMesh(const std::filesystem::path& path, const LoadMeshOptions& options = {});

/// The same from bytes in memory; files that the CAD file refers to are not accessible. The extension of `name` gives
/// the format; error messages contain `name`.
[[nodiscard]] Expected<LoadedMesh> DecodeMesh(std::span<const std::byte> bytes, const std::string& name,
                                              const LoadMeshOptions& options = {});

}  // namespace victorious

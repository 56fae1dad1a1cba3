// A CAD file in, a Mesh out: glTF and GLB, OBJ (with its mtl), AC3D, COLLADA, 3DS, PLY, STL.
//
// A CAD file is outside bytes, and the library that reads them (assimp) was not made for hostile ones. It therefore
// runs in a process of its own with bounded memory and time: a file that crashes it is an error of one line, like any
// other damage. See docs/adr/0007-renderer.md. Only files in the CAD file's own folder, and below it, are ever read.
//
// Axes, turned into the model frame of mesh.h:
//   glTF, OBJ, AC3D   Y up, front +Z
//   COLLADA           up as the file says; front +Z where Y is up, -Y where Z is up, +Z where X is up
//   3DS, PLY, STL     Z up, front -Y
//
// Colours of glTF are linear; those of the other formats, textures apart, are taken for sRGB, as their editors show
// them. The other formats say nothing of sides: their triangles are seen from both. Their textures with an alpha
// channel are masks (AlphaMode::kMask), materials with an opacity below 1 are blended.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/render/mesh.h"

namespace victorious {

/// An axis of the CAD file's own frame.
enum class Axis { kPlusX, kMinusX, kPlusY, kMinusY, kPlusZ, kMinusZ };

/// "x", "+x", "-x", …, in either case.
Expected<Axis> ParseAxis(std::string_view text);

/// Whether a file's name ends as one of these formats' does, in either case.
bool IsCadFile(const std::filesystem::path& path);

struct LoadMeshOptions {
  std::optional<Axis> up;          ///< unless given, the format's
  std::optional<Axis> front;       ///< unless given, the one that goes with `up`: +Z; with Z up -Y
  std::optional<double> length_m;  ///< the object's length (LoadedMesh); unless given, the file's unit is the metre
                                   ///< (COLLADA names its own)
};

/// What is read at most; more is refused (kUnsupported).
inline constexpr std::uint64_t kMaxCadBytes = std::uint64_t{256} << 20;  ///< of the file, and of each file beside it
inline constexpr std::size_t kMaxTriangles = 4'000'000;
inline constexpr int kMaxTextureSide = 8192;                              ///< px
inline constexpr std::uint64_t kMaxImportBytes = std::uint64_t{3} << 30;  ///< of memory while reading
inline constexpr unsigned kMaxImportSeconds = 10;  ///< of processor time; 1 s more for each 4 MiB of the file

struct LoadedMesh {
  Mesh mesh;                          ///< with at least one triangle
  double length_m = 0;                ///< of a glTF: its extent along its front axis; else its longest side
  std::vector<std::string> warnings;  ///< one line each: what is missing or damaged and was left out
};

/// Reads a CAD file. What is damaged in part is read as far as it goes, with a warning: a missing texture leaves the
/// material's colour, a triangle with a corner that is not a number or does not exist is left out.
/// Errors: kNotFound, kInvalidArgument (options), kDataLoss (nothing that can be drawn), kUnsupported (the format, or
/// too large: beyond the limits above, or 3 GiB of memory or a minute of processor time to read).
Expected<LoadedMesh> LoadMesh(const std::filesystem::path& path, const LoadMeshOptions& options = {});

/// The same from bytes in memory, without any file beside them. `name`: for the format (its ending) and the error's
/// text.
Expected<LoadedMesh> DecodeMesh(std::span<const std::byte> bytes, const std::string& name,
                                const LoadMeshOptions& options = {});

}  // namespace victorious

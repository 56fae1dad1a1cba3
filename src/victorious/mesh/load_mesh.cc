#include "victorious/mesh/load_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "victorious/base/file.h"
#include "victorious/base/text.h"
#include "victorious/mesh/assimp_import.h"
#include "victorious/mesh/cad_folder.h"
#include "victorious/mesh/isolated.h"
#include "victorious/mesh/mesh_bytes.h"
#include "victorious/mesh/normals.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 6> kAxisNames = {"+x", "-x", "+y", "-y", "+z", "-z"};

int AxisIndex(Axis axis) { return static_cast<int>(axis) / 2; }

Eigen::Vector3f AxisVector(Axis axis) {
  const bool minus = static_cast<int>(axis) % 2 == 1;
  return Eigen::Vector3f::Unit(AxisIndex(axis)) * (minus ? -1.0F : 1.0F);
}

// The default front axis for an up axis: the side that editors show in their front view.
Axis DefaultFront(Axis up) { return AxisIndex(up) == 2 ? Axis::kMinusY : Axis::kPlusZ; }

struct Axes {
  Axis up;
  Axis front;
};

Expected<Axes> ResolveAxes(const LoadMeshOptions& options, Axis own_up) {
  const Axis up = options.up.value_or(own_up);
  const Axis front = options.front.value_or(DefaultFront(up));
  if (AxisIndex(up) == AxisIndex(front)) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("front {} and up {}: must be two different axes",
                            kAxisNames[static_cast<std::size_t>(front)], kAxisNames[static_cast<std::size_t>(up)]));
  }
  return Axes{up, front};
}

void RotateIntoModelFrame(Mesh& mesh, const Axes& axes) {
  const Eigen::Vector3f up = AxisVector(axes.up);
  const Eigen::Vector3f front = AxisVector(axes.front);
  Eigen::Matrix3f model_from_file;
  model_from_file << front.transpose(), up.cross(front).transpose(), up.transpose();
  const auto turn = [&](Eigen::Vector3f& vector) { vector = model_from_file * vector; };
  std::ranges::for_each(mesh.positions, turn);
  std::ranges::for_each(mesh.normals, turn);
}

// LoadedMesh::length_m for a box of this size. Also the longest side for a glTF without extent along its front axis.
double ObjectLength(const Eigen::Vector3d& size, CadFormat format) {
  return format == CadFormat::kGltf && size.x() > 0 ? size.x() : size.maxCoeff();
}

Status Scale(Mesh& mesh, CadFormat format, const std::optional<double>& length_m) {
  const Eigen::Vector3d size = BoundingBox(mesh).sizes();
  const double length = ObjectLength(size, format);
  if (!(length > 0)) {
    return Fail(ErrorCode::kDataLoss, "all triangles lie in one point: the mesh must have an extent");
  }
  const float scale = length_m ? static_cast<float>(*length_m / length) : 1.0F;
  for (Eigen::Vector3f& position : mesh.positions) position *= scale;
  constexpr double kMaxLength_m = 1e6;
  constexpr double kMinLength_m = 1e-6;
  const double largest = size.maxCoeff() * scale;
  if (!(largest < kMaxLength_m) || !(largest > kMinLength_m) || !(BoundingSphere(mesh).centre.norm() < kMaxLength_m)) {
    return Fail(ErrorCode::kDataLoss,
                fmt::format("{:g} m long, or far from the origin: must be {:g} to {:g} m; its length may be given",
                            largest, kMinLength_m, kMaxLength_m));
  }
  return {};
}

Expected<LoadedMesh> ImportIntoModelFrame(const CadFolder& folder, CadFormat format, const LoadMeshOptions& options) {
  VICTORIOUS_ASSIGN_OR_RETURN(ImportedMesh imported, ImportMesh(folder, format));
  VICTORIOUS_ASSIGN_OR_RETURN(const Axes axes, ResolveAxes(options, imported.up));
  Mesh& mesh = imported.loaded.mesh;
  if (mesh.triangles.empty()) {
    const std::string why = imported.loaded.warnings.empty() ? "" : " (" + imported.loaded.warnings.back() + ")";
    return Fail(ErrorCode::kDataLoss, "no triangle can be drawn" + why);
  }
  RotateIntoModelFrame(mesh, axes);
  VICTORIOUS_RETURN_IF_ERROR(Scale(mesh, format, options.length_m));
  FillMissingNormals(mesh);
  return std::move(imported.loaded);
}

Expected<LoadedMesh> Load(std::span<const std::byte> bytes, const std::string& name, std::optional<fs::path> folder,
                          const LoadMeshOptions& options) {
  const auto format = CadFormatFromName(name);
  if (!format) {
    return Fail(ErrorCode::kUnsupported,
                fmt::format("{}: not a CAD file (.gltf, .glb, .obj, .ac, .dae, .3ds, .ply or .stl)", name));
  }
  if (options.length_m && !(*options.length_m > 0 && std::isfinite(*options.length_m))) {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("length {} m: must be above 0", *options.length_m));
  }
  const CadFolder cad_folder(bytes, fs::path(name).filename().string(), std::move(folder));
  const auto import = [&]() -> Expected<std::string> {
    VICTORIOUS_ASSIGN_OR_RETURN(const LoadedMesh loaded, ImportIntoModelFrame(cad_folder, *format, options));
    return BytesFromMesh(loaded);
  };
  const unsigned processor_s = kMaxImportSeconds + static_cast<unsigned>(bytes.size() >> 22);
  auto result = RunIsolated(import, {.memory_bytes = kMaxImportBytes, .processor_s = processor_s});
  if (!result) return std::unexpected(std::move(result).error().WithContext(name));
  auto loaded = MeshFromBytes(*result);
  if (!loaded) return std::unexpected(std::move(loaded).error().WithContext(name));
  loaded->length_m = ObjectLength(BoundingBox(loaded->mesh).sizes(), *format);
  return loaded;
}

}  // namespace

bool IsCadFile(const fs::path& path) { return CadFormatFromName(path.string()).has_value(); }

Expected<Axis> ParseAxis(std::string_view text) {
  std::string name = LowerCase(text);
  if (name.size() == 1) name.insert(0, "+");
  const auto found = std::ranges::find(kAxisNames, name);
  if (found == kAxisNames.end()) {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("axis '{}': must be x, y, z, -x, -y or -z", text));
  }
  return static_cast<Axis>(found - kAxisNames.begin());
}

Expected<LoadedMesh> LoadMesh(const fs::path& path, const LoadMeshOptions& options) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string bytes, ReadFile(path, kMaxCadBytes));
  return Load(std::as_bytes(std::span(bytes)), path.string(), path.parent_path(), options);
}

Expected<LoadedMesh> DecodeMesh(std::span<const std::byte> bytes, const std::string& name,
                                const LoadMeshOptions& options) {
  return Load(bytes, name, std::nullopt, options);
}

}  // namespace victorious

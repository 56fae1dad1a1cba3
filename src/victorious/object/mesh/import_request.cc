#include "victorious/object/mesh/import_request.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <new>
#include <utility>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "victorious/base/check.h"
#include "victorious/base/packed_bytes.h"
#include "victorious/object/mesh/cad_folder.h"
#include "victorious/object/mesh/mesh_bytes.h"
#include "victorious/object/mesh/normals.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;

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
  if (!(largest < kMaxLength_m) || !(largest > kMinLength_m)) {
    return Fail(ErrorCode::kDataLoss, fmt::format("{:g} m long: must be {:g} to {:g} m; its length may be given",
                                                  largest, kMinLength_m, kMaxLength_m));
  }
  const double distance = BoundingSphere(mesh).centre.norm();
  if (!(distance < kMaxLength_m)) {
    return Fail(ErrorCode::kDataLoss, fmt::format("{:g} m from its origin, which leaves no detail: move the model to "
                                                  "its origin",
                                                  distance));
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

std::optional<Axis> GetAxis(ByteReader& reader) {
  return reader.Get<bool>() ? std::optional(reader.GetEnum(Axis::kMinusZ)) : std::nullopt;
}

}  // namespace

// Also the longest side for a glTF without extent along its front axis.
double ObjectLength(const Eigen::Vector3d& size, CadFormat format) {
  return format == CadFormat::kGltf && size.x() > 0 ? size.x() : size.maxCoeff();
}

// The size of the head stands first, so that the bytes of the file are copied only once.
std::string PackImportRequest(const ImportRequest& request, std::span<const std::byte> file) {
  ByteWriter writer;
  writer.Put(request.format);
  writer.PutOptional(request.options.up);
  writer.PutOptional(request.options.front);
  writer.PutOptional(request.options.length_m);
  writer.PutText(request.name);
  writer.Put(request.folder.has_value());
  writer.PutText(request.folder.value_or("").string());
  const std::vector<std::byte> head = writer.Take();
  const std::uint64_t head_bytes = head.size();
  std::string packed;
  packed.reserve(sizeof(head_bytes) + head.size() + file.size());
  packed.append(reinterpret_cast<const char*>(&head_bytes), sizeof(head_bytes));
  packed.append(reinterpret_cast<const char*>(head.data()), head.size());
  packed.append(reinterpret_cast<const char*>(file.data()), file.size());
  return packed;
}

Expected<std::string> ImportMeshRequest(std::string_view packed) {
  std::span<const std::byte> bytes = std::as_bytes(std::span(packed));
  const auto head_bytes = ByteReader(bytes).Get<std::uint64_t>();
  bytes = bytes.subspan(sizeof(head_bytes));
  ByteReader reader(bytes.first(head_bytes));
  ImportRequest request;
  request.format = reader.GetEnum(CadFormat::kStl);
  request.options.up = GetAxis(reader);
  request.options.front = GetAxis(reader);
  request.options.length_m = reader.GetOptional<double>();
  request.name = reader.GetText();
  const bool has_folder = reader.Get<bool>();
  fs::path folder = reader.GetText();
  if (has_folder) request.folder = std::move(folder);
  VICTORIOUS_CHECK(reader.IsAtEnd());
  try {
    const CadFolder files(bytes.subspan(head_bytes), request.name, request.folder);
    VICTORIOUS_ASSIGN_OR_RETURN(const LoadedMesh loaded, ImportIntoModelFrame(files, request.format, request.options));
    return BytesFromMesh(loaded);
  } catch (const cv::Exception& exception) {
    if (exception.code != cv::Error::StsNoMem) throw;
    throw std::bad_alloc();
  }
}

}  // namespace victorious

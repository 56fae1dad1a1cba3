#include "victorious/object/mesh/mesh_bytes.h"

#include <algorithm>
#include <cstring>
#include <type_traits>

#include <opencv2/core.hpp>

namespace victorious {
namespace {

// Fixed-size Eigen vectors of floats are plain data, although std::is_trivially_copyable is false for them.
template <typename T>
struct IsPlain : std::is_trivially_copyable<T> {};
template <int Size>
struct IsPlain<Eigen::Matrix<float, Size, 1>> : std::true_type {};

class Writer {
 public:
  template <typename T>
  void Value(const T& value) {
    static_assert(IsPlain<T>::value);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  template <typename T>
  void Array(const std::vector<T>& values) {
    static_assert(IsPlain<T>::value);
    Value<std::uint64_t>(values.size());
    bytes_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
  }
  void Text(const std::string& text) {
    Value<std::uint64_t>(text.size());
    bytes_ += text;
  }
  void Texture(const cv::Mat& bgra) {
    Value(bgra.cols);
    Value(bgra.rows);
    for (int row = 0; row < bgra.rows; ++row) {
      bytes_.append(bgra.ptr<char>(row), static_cast<std::size_t>(bgra.cols) * 4);
    }
  }
  std::string Take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

// After a read beyond the end, ok() is false and all further reads return zero or empty.
class Reader {
 public:
  explicit Reader(std::string_view bytes) : rest_(bytes) {}

  [[nodiscard]] bool ok() const { return ok_; }

  template <typename T>
  T Value() {
    T value = {};
    if (const std::string_view bytes = Take(sizeof value); !bytes.empty()) {
      std::memcpy(static_cast<void*>(&value), bytes.data(), sizeof value);
    }
    return value;
  }
  template <typename T>
  std::vector<T> Array() {
    std::vector<T> values(Count(sizeof(T)));
    const std::string_view bytes = Take(values.size() * sizeof(T));
    if (!bytes.empty()) std::memcpy(static_cast<void*>(values.data()), bytes.data(), bytes.size());
    return values;
  }
  std::string Text() { return std::string(Take(Count(1))); }
  cv::Mat Texture() {
    const int cols = Value<int>();
    const int rows = Value<int>();
    if (cols < 1 || rows < 1 || cols > kMaxTextureSide || rows > kMaxTextureSide) ok_ = false;
    const std::string_view bytes = ok_ ? Take(std::size_t{4} * cols * rows) : std::string_view();
    if (bytes.empty()) return {};
    return cv::Mat(rows, cols, CV_8UC4, const_cast<char*>(bytes.data())).clone();
  }
  /// Reads the number of items that follow, each at least `item_bytes` long.
  std::size_t Count(std::size_t item_bytes) {
    const auto count = Value<std::uint64_t>();
    if (count > rest_.size() / item_bytes) ok_ = false;
    return ok_ ? count : 0;
  }

 private:
  std::string_view Take(std::size_t size) {
    if (size > rest_.size()) ok_ = false;
    if (!ok_) return {};
    const std::string_view taken = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return taken;
  }

  std::string_view rest_;
  bool ok_ = true;
};

void Write(Writer& writer, const Material& material) {
  writer.Text(material.name);
  writer.Value(material.base_colour);
  writer.Value(material.texture);
  writer.Value(material.wrap_u);
  writer.Value(material.wrap_v);
  writer.Value(material.alpha_mode);
  writer.Value(material.alpha_cutoff);
  writer.Value<std::uint8_t>(material.double_sided ? 1 : 0);
}

Material ReadMaterial(Reader& reader) {
  Material material;
  material.name = reader.Text();
  material.base_colour = reader.Value<Eigen::Vector4f>();
  material.texture = reader.Value<int>();
  material.wrap_u = reader.Value<TextureWrap>();
  material.wrap_v = reader.Value<TextureWrap>();
  material.alpha_mode = reader.Value<AlphaMode>();
  material.alpha_cutoff = reader.Value<float>();
  material.double_sided = reader.Value<std::uint8_t>() != 0;
  return material;
}

bool PartsCoverTriangles(const Mesh& mesh) {
  std::uint64_t next = 0;
  for (const MeshPart& part : mesh.parts) {
    const bool known = part.material >= 0 && static_cast<std::size_t>(part.material) < mesh.materials.size();
    if (!known || part.first_triangle != next) return false;
    next += part.triangles;
  }
  return next == mesh.triangles.size();
}

bool IsConsistent(const Mesh& mesh) {
  const std::size_t vertices = mesh.positions.size();
  const auto has_corners = [&](const auto& triangle) {
    return std::ranges::all_of(
        triangle, [&](std::uint32_t corner) { return corner < vertices && mesh.positions[corner].allFinite(); });
  };
  const auto is_usable = [&](const Material& material) {
    const auto is_wrap = [](TextureWrap wrap) { return wrap >= TextureWrap::kRepeat && wrap <= TextureWrap::kMirror; };
    return material.texture >= -1 && material.texture < static_cast<int>(mesh.textures.size()) &&
           material.alpha_mode >= AlphaMode::kOpaque && material.alpha_mode <= AlphaMode::kBlend &&
           is_wrap(material.wrap_u) && is_wrap(material.wrap_v);
  };
  return mesh.normals.size() == vertices && mesh.uvs.size() == vertices &&
         (mesh.colours.empty() || mesh.colours.size() == vertices) &&
         std::ranges::all_of(mesh.triangles, has_corners) && std::ranges::all_of(mesh.materials, is_usable) &&
         PartsCoverTriangles(mesh);
}

}  // namespace

std::string BytesFromMesh(const LoadedMesh& loaded) {
  const Mesh& mesh = loaded.mesh;
  Writer writer;
  writer.Array(mesh.positions);
  writer.Array(mesh.normals);
  writer.Array(mesh.uvs);
  writer.Array(mesh.colours);
  writer.Array(mesh.triangles);
  writer.Array(mesh.parts);
  writer.Value<std::uint64_t>(mesh.materials.size());
  for (const Material& material : mesh.materials) Write(writer, material);
  writer.Value<std::uint64_t>(mesh.textures.size());
  for (const cv::Mat& texture : mesh.textures) writer.Texture(texture);
  writer.Value<std::uint64_t>(loaded.warnings.size());
  for (const std::string& warning : loaded.warnings) writer.Text(warning);
  return writer.Take();
}

Expected<LoadedMesh> MeshFromBytes(std::string_view bytes) {
  Reader reader(bytes);
  LoadedMesh loaded;
  Mesh& mesh = loaded.mesh;
  mesh.positions = reader.Array<Eigen::Vector3f>();
  mesh.normals = reader.Array<Eigen::Vector3f>();
  mesh.uvs = reader.Array<Eigen::Vector2f>();
  mesh.colours = reader.Array<Eigen::Vector4f>();
  mesh.triangles = reader.Array<std::array<std::uint32_t, 3>>();
  mesh.parts = reader.Array<MeshPart>();
  for (std::size_t left = reader.Count(1); left > 0 && reader.ok(); --left) {
    mesh.materials.push_back(ReadMaterial(reader));
  }
  for (std::size_t left = reader.Count(1); left > 0 && reader.ok(); --left) {
    mesh.textures.push_back(reader.Texture());
  }
  for (std::size_t left = reader.Count(1); left > 0 && reader.ok(); --left) loaded.warnings.push_back(reader.Text());
  if (!reader.ok() || !IsConsistent(mesh)) {
    return Fail(ErrorCode::kDataLoss, "damaged: the importer returned an inconsistent mesh");
  }
  return loaded;
}

}  // namespace victorious

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "assets/make/asset.h"

static_assert(std::endian::native == std::endian::little, "GLB is little-endian, and so is what is written here");

namespace victorious::assets {
namespace {

using Json = nlohmann::ordered_json;

// Constants of glTF 2.0: component types and buffer targets.
constexpr int kUnsignedShort = 5123;
constexpr int kUnsignedInt = 5125;
constexpr int kFloat = 5126;
constexpr int kArrayBuffer = 34962;
constexpr int kElementArrayBuffer = 34963;

/// A growing binary chunk, with its buffer views and accessors.
struct Binary {
  std::string bytes;
  Json views = Json::array();
  Json accessors = Json::array();

  int AddView(std::span<const std::byte> data, int target) {
    bytes.resize((bytes.size() + 3) / 4 * 4, '\0');
    Json view = {{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", data.size()}};
    if (target != 0) view["target"] = target;
    bytes.append(reinterpret_cast<const char*>(data.data()), data.size());
    views.push_back(std::move(view));
    return static_cast<int>(views.size()) - 1;
  }

  template <typename T>
  int AddAccessor(const std::vector<T>& values, int component, const char* type, int target) {
    const int view = AddView(std::as_bytes(std::span(values)), target);
    accessors.push_back({{"bufferView", view}, {"componentType", component}, {"count", values.size()}, {"type", type}});
    return static_cast<int>(accessors.size()) - 1;
  }
};

void AppendWord(std::string& bytes, std::uint32_t word) {
  std::array<char, 4> raw;
  std::memcpy(raw.data(), &word, raw.size());
  bytes.append(raw.data(), raw.size());
}

void AppendChunk(std::string& bytes, std::string chunk, std::uint32_t type, char padding) {
  chunk.resize((chunk.size() + 3) / 4 * 4, padding);
  AppendWord(bytes, static_cast<std::uint32_t>(chunk.size()));
  AppendWord(bytes, type);
  bytes += chunk;
}

int AddIndices(Binary& binary, const TexturedMesh& model) {
  if (model.positions.size() > 0xFFFF) {
    return binary.AddAccessor(model.indices, kUnsignedInt, "SCALAR", kElementArrayBuffer);
  }
  const std::vector<std::uint16_t> narrow(model.indices.begin(), model.indices.end());
  return binary.AddAccessor(narrow, kUnsignedShort, "SCALAR", kElementArrayBuffer);
}

Json Attributes(Binary& binary, const TexturedMesh& model) {
  Vec3 least = model.positions.front();
  Vec3 greatest = least;
  for (const Vec3& position : model.positions) {
    least = least.cwiseMin(position);
    greatest = greatest.cwiseMax(position);
  }
  const int position = binary.AddAccessor(model.positions, kFloat, "VEC3", kArrayBuffer);
  binary.accessors[position]["min"] = {least.x(), least.y(), least.z()};
  binary.accessors[position]["max"] = {greatest.x(), greatest.y(), greatest.z()};
  const int normal = binary.AddAccessor(model.normals, kFloat, "VEC3", kArrayBuffer);
  const int uv = binary.AddAccessor(model.uvs, kFloat, "VEC2", kArrayBuffer);
  return {{"POSITION", position}, {"NORMAL", normal}, {"TEXCOORD_0", uv}};
}

}  // namespace

Expected<std::string> GlbBytes(const std::string& name, const TexturedMesh& model) {
  std::vector<unsigned char> jpeg;
  if (!cv::imencode(".jpg", model.texture, jpeg, {cv::IMWRITE_JPEG_QUALITY, model.jpeg_quality})) {
    return Fail(ErrorCode::kInternal, "cannot encode the texture of " + name + " as JPEG");
  }
  Binary binary;
  const Json attributes = Attributes(binary, model);
  const int indices = AddIndices(binary, model);
  const int image = binary.AddView(std::as_bytes(std::span(jpeg)), 0);
  const Json document = {
      {"asset", {{"version", "2.0"}, {"generator", "VICTORIOUS make_assets"}}},
      {"scene", 0},
      {"scenes", {{{"nodes", {0}}}}},
      {"nodes", {{{"name", name}, {"mesh", 0}}}},
      {"meshes",
       {{{"name", name}, {"primitives", {{{"attributes", attributes}, {"indices", indices}, {"material", 0}}}}}}},
      {"materials",
       {{{"name", name},
         {"pbrMetallicRoughness",
          {{"baseColorTexture", {{"index", 0}}}, {"metallicFactor", 0.0}, {"roughnessFactor", 0.9}}}}}},
      {"textures", {{{"source", 0}, {"sampler", 0}}}},
      {"samplers", {{{"magFilter", 9729}, {"minFilter", 9987}}}},
      {"images", {{{"bufferView", image}, {"mimeType", "image/jpeg"}}}},
      {"accessors", binary.accessors},
      {"bufferViews", binary.views},
      {"buffers", {{{"byteLength", (binary.bytes.size() + 3) / 4 * 4}}}},
  };
  std::string chunks;
  AppendChunk(chunks, document.dump(), 0x4E4F534A, ' ');
  AppendChunk(chunks, binary.bytes, 0x004E4942, '\0');
  std::string glb;
  AppendWord(glb, 0x46546C67);
  AppendWord(glb, 2);
  AppendWord(glb, static_cast<std::uint32_t>(12 + chunks.size()));
  return glb + chunks;
}

}  // namespace victorious::assets

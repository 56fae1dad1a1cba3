#include "victorious/object/mesh/gltf_file.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>

#include <nlohmann/json.hpp>

#include "victorious/object/mesh/load_mesh.h"

namespace victorious {
namespace {

using nlohmann::json;

constexpr std::string_view kMagic = "glTF";
constexpr std::uint32_t kJsonChunk = 0x4E4F534A;
constexpr std::uint32_t kBinaryChunk = 0x004E4942;
constexpr std::string_view kBase64 = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

// glTF 2.0, 3.6.2: the component types.
constexpr int kByte = 5120;
constexpr int kUnsignedByte = 5121;
constexpr int kShort = 5122;
constexpr int kUnsignedShort = 5123;
constexpr int kUnsignedInt = 5125;
constexpr int kFloat = 5126;

std::optional<std::uint32_t> UintAt(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  if (at + sizeof(value) > bytes.size()) return std::nullopt;
  std::memcpy(&value, bytes.data() + at, sizeof(value));
  return value;
}

void PutUint(std::string& bytes, std::size_t value) {
  const auto number = static_cast<std::uint32_t>(value);
  bytes.append(reinterpret_cast<const char*>(&number), sizeof(number));
}

// RFC 4648; other characters are skipped.
std::string DecodeBase64(std::string_view text) {
  std::array<int, 256> value{};
  value.fill(-1);
  for (std::size_t i = 0; i < kBase64.size(); ++i) value[static_cast<unsigned char>(kBase64[i])] = static_cast<int>(i);
  std::string decoded;
  decoded.reserve(text.size() / 4 * 3);
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    const int six = value[static_cast<unsigned char>(c)];
    if (six < 0) continue;
    bits = (bits << 6) | static_cast<std::uint32_t>(six);
    if (++count % 4 == 1) continue;
    decoded.push_back(static_cast<char>(bits >> (6 - 2 * ((count - 1) % 4))));
  }
  return decoded;
}

std::string EncodeBase64(std::string_view bytes) {
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    for (std::size_t k = 0; k < 3; ++k)
      bits = (bits << 8) | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k) text.push_back(k <= count ? kBase64[(bits >> (18 - 6 * k)) & 63U] : '=');
  }
  return text;
}

std::optional<std::size_t> SizeOf(const json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end()) return std::nullopt;
  if (!found->is_number_integer() || (!found->is_number_unsigned() && found->get<std::int64_t>() < 0))
    return std::nullopt;
  return found->get<std::size_t>();
}

std::size_t ComponentsOf(const json& accessor) {
  static const std::map<std::string, std::size_t> kComponents = {
      {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT4", 16}};
  const auto type = accessor.find("type");
  if (type == accessor.end() || !type->is_string()) return 0;
  const auto found = kComponents.find(type->get<std::string>());
  return found == kComponents.end() ? 0 : found->second;
}

std::size_t BytesOf(std::size_t component) {
  switch (component) {
    case kByte:
    case kUnsignedByte:
      return 1;
    case kShort:
    case kUnsignedShort:
      return 2;
    case kUnsignedInt:
    case kFloat:
      return 4;
    default:
      return 0;
  }
}

template <typename T>
double NumberAt(const char* at, bool is_normalised) {
  T value{};
  std::memcpy(&value, at, sizeof(value));
  if constexpr (std::is_integral_v<T>) {
    // glTF 2.0, 3.11: signed ones end at -1.
    if (is_normalised) return std::max(-1.0, static_cast<double>(value) / std::numeric_limits<T>::max());
  }
  return static_cast<double>(value);
}

double ValueAt(const char* at, std::size_t component, bool is_normalised) {
  switch (component) {
    case kByte:
      return NumberAt<std::int8_t>(at, is_normalised);
    case kUnsignedByte:
      return NumberAt<std::uint8_t>(at, is_normalised);
    case kShort:
      return NumberAt<std::int16_t>(at, is_normalised);
    case kUnsignedShort:
      return NumberAt<std::uint16_t>(at, is_normalised);
    case kUnsignedInt:
      return NumberAt<std::uint32_t>(at, is_normalised);
    default:
      return NumberAt<float>(at, is_normalised);
  }
}

}  // namespace

GltfFile::GltfFile(const CadFolder& folder) : folder_(&folder), document_(std::make_unique<json>()) {}
GltfFile::GltfFile(GltfFile&&) noexcept = default;
GltfFile::~GltfFile() = default;

std::optional<GltfFile> GltfFile::Read(const CadFolder& folder) {
  GltfFile file(folder);
  std::string_view text = folder.text();
  if (text.starts_with(kMagic)) {
    file.is_glb_ = true;
    constexpr std::size_t kHead = 12;
    const auto size = UintAt(text, kHead);
    if (!size || UintAt(text, kHead + 4) != kJsonChunk || *size > text.size() - kHead - 8) return std::nullopt;
    const std::size_t next = kHead + 8 + *size;
    const auto more = UintAt(text, next);
    if (more && UintAt(text, next + 4) == kBinaryChunk && *more <= text.size() - next - 8)
      file.binary_ = std::string(text.substr(next + 8, *more));
    text = text.substr(kHead + 8, *size);
  }
  file.document() = json::parse(text, nullptr, false);
  if (!file.document().is_object()) return std::nullopt;
  return file;
}

json* GltfFile::Find(std::string_view list, const json& index) {
  const auto found = document_->find(list);
  if (found == document_->end() || !found->is_array() || !index.is_number_unsigned()) return nullptr;
  const auto at = index.get<std::size_t>();
  return at < found->size() && (*found)[at].is_object() ? &(*found)[at] : nullptr;
}

const std::string* GltfFile::ReadBuffer(std::size_t index) {
  if (const auto found = buffers_.find(index); found != buffers_.end()) return &found->second;
  const json* buffer = Find("buffers", index);
  if (buffer == nullptr) return nullptr;
  const auto uri = buffer->find("uri");
  if (uri == buffer->end()) return index == 0 && binary_ ? &*binary_ : nullptr;
  if (!uri->is_string()) return nullptr;
  const std::string text = uri->get<std::string>();
  if (text.starts_with("data:")) {
    const std::size_t comma = text.find(',');
    if (comma == std::string::npos) return nullptr;
    return &(buffers_[index] = DecodeBase64(std::string_view(text).substr(comma + 1)));
  }
  auto bytes = folder_->Read(text);
  return bytes ? &(buffers_[index] = *std::move(bytes)) : nullptr;
}

bool GltfFile::IsFloat(const json& index) {
  const json* accessor = Find("accessors", index);
  return accessor == nullptr || SizeOf(*accessor, "componentType") == kFloat;
}

std::optional<AccessorValues> GltfFile::ReadAccessor(const json& index) {
  const json* accessor = Find("accessors", index);
  if (accessor == nullptr || accessor->contains("sparse") || !accessor->contains("bufferView")) return std::nullopt;
  const json* view = Find("bufferViews", (*accessor)["bufferView"]);
  if (view == nullptr || view->contains("extensions")) return std::nullopt;
  const auto buffer_index = SizeOf(*view, "buffer");
  const std::string* buffer = buffer_index ? ReadBuffer(*buffer_index) : nullptr;
  const std::size_t count = SizeOf(*accessor, "count").value_or(0);
  const std::size_t component = SizeOf(*accessor, "componentType").value_or(0);
  const std::size_t components = ComponentsOf(*accessor);
  const std::size_t element = BytesOf(component) * components;
  const std::size_t stride = std::max(element, SizeOf(*view, "byteStride").value_or(element));
  const std::size_t first = SizeOf(*view, "byteOffset").value_or(0) + SizeOf(*accessor, "byteOffset").value_or(0);
  constexpr std::size_t kMaxStride = 252;
  if (buffer == nullptr || element == 0 || count == 0 || count > 3 * kMaxTriangles || stride > kMaxStride ||
      first > buffer->size() || (count - 1) * stride + element > buffer->size() - first)
    return std::nullopt;
  const auto normalised = accessor->find("normalized");
  const bool is_normalised = normalised != accessor->end() && normalised->is_boolean() && normalised->get<bool>();
  AccessorValues result{.components = components, .values = {}};
  result.values.reserve(count * components);
  for (std::size_t i = 0; i < count; ++i) {
    const char* at = buffer->data() + first + i * stride;
    for (std::size_t k = 0; k < components; ++k, at += BytesOf(component))
      result.values.push_back(ValueAt(at, component, is_normalised));
  }
  return result;
}

std::size_t GltfFile::AddAccessor(const AccessorValues& values) {
  static constexpr std::array<const char*, 4> kTypes = {"SCALAR", "VEC2", "VEC3", "VEC4"};
  const std::size_t first = added_.size();
  for (const double value : values.values) {
    const auto number = static_cast<float>(value);
    added_.append(reinterpret_cast<const char*>(&number), sizeof(number));
  }
  json& views = (*document_)["bufferViews"];
  views.push_back(
      {{"buffer", (*document_)["buffers"].size()}, {"byteOffset", first}, {"byteLength", added_.size() - first}});
  json& accessors = (*document_)["accessors"];
  accessors.push_back({{"bufferView", views.size() - 1},
                       {"componentType", kFloat},
                       {"count", values.count()},
                       {"type", kTypes.at(values.components - 1)}});
  return accessors.size() - 1;
}

std::string GltfFile::Write() const {
  json written = *document_;
  if (!added_.empty()) {
    written["buffers"].push_back(
        {{"byteLength", added_.size()}, {"uri", "data:application/octet-stream;base64," + EncodeBase64(added_)}});
  }
  std::string text = written.dump(-1, ' ', false, json::error_handler_t::replace);
  if (!is_glb_) return text;
  text.append((4 - text.size() % 4) % 4, ' ');
  std::string file(kMagic);
  PutUint(file, 2);
  PutUint(file, 12 + 8 + text.size() + (binary_ ? 8 + binary_->size() : 0));
  PutUint(file, text.size());
  PutUint(file, kJsonChunk);
  file += text;
  if (binary_) {
    PutUint(file, binary_->size());
    PutUint(file, kBinaryChunk);
    file += *binary_;
  }
  return file;
}

}  // namespace victorious

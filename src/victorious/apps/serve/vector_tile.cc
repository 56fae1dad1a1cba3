#include "victorious/apps/serve/vector_tile.h"

#include <bit>
#include <cstring>

namespace victorious {
namespace {

// Wire types of Protocol Buffers.
constexpr std::uint32_t kVarint = 0;
constexpr std::uint32_t k64Bit = 1;
constexpr std::uint32_t kBytes = 2;

// Commands and types of the specification, section 4.3.
constexpr std::uint32_t kMoveTo = 1;
constexpr std::uint32_t kLineTo = 2;
constexpr std::uint32_t kClosePath = 7;
constexpr int kPointType = 1;
constexpr int kPolygonType = 3;

void PutVarint(std::uint64_t value, std::string& out) {
  while (value >= 0x80) {
    out += static_cast<char>((value & 0x7f) | 0x80);
    value >>= 7;
  }
  out += static_cast<char>(value);
}

void PutTag(std::uint32_t field, std::uint32_t wire_type, std::string& out) { PutVarint(field << 3 | wire_type, out); }

void PutInteger(std::uint32_t field, std::uint64_t value, std::string& out) {
  PutTag(field, kVarint, out);
  PutVarint(value, out);
}

void PutBytes(std::uint32_t field, std::string_view bytes, std::string& out) {
  PutTag(field, kBytes, out);
  PutVarint(bytes.size(), out);
  out += bytes;
}

void PutPacked(std::uint32_t field, std::span<const std::uint32_t> numbers, std::string& out) {
  std::string packed;
  for (const std::uint32_t number : numbers) PutVarint(number, packed);
  PutBytes(field, packed, out);
}

constexpr std::uint32_t ZigZag(std::int32_t value) {
  return (static_cast<std::uint32_t>(value) << 1) ^ static_cast<std::uint32_t>(value >> 31);
}

constexpr std::uint32_t Command(std::uint32_t id, std::uint32_t count) { return (id & 7) | (count << 3); }

std::string EncodeValue(const TileValue& value) {
  std::string out;
  if (const auto* text = std::get_if<std::string>(&value)) {
    PutBytes(1, *text, out);
  } else if (const auto* number = std::get_if<double>(&value)) {
    PutTag(3, k64Bit, out);
    const auto bits = std::bit_cast<std::uint64_t>(*number);
    for (int byte = 0; byte < 8; ++byte) out += static_cast<char>(bits >> (8 * byte) & 0xff);
  } else if (const auto* integer = std::get_if<std::int64_t>(&value)) {
    PutInteger(6, (static_cast<std::uint64_t>(*integer) << 1) ^ static_cast<std::uint64_t>(*integer >> 63), out);
  } else {
    PutInteger(7, std::get<bool>(value) ? 1 : 0, out);
  }
  return out;
}

// Twice the area by the surveyor's formula; positive if clockwise on screen, where y points down.
std::int64_t DoubleArea(std::span<const TilePoint> ring) {
  std::int64_t sum = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const TilePoint& a = ring[i];
    const TilePoint& b = ring[(i + 1) % ring.size()];
    sum += std::int64_t{a.x} * b.y - std::int64_t{b.x} * a.y;
  }
  return sum;
}

}  // namespace

void TileLayer::AddFeature(std::uint64_t id, int type, std::span<const std::uint32_t> geometry,
                           const TileAttributes& attributes) {
  std::vector<std::uint32_t> tags;
  for (const auto& [key, value] : attributes) {
    auto at = key_indices_.find(key);
    if (at == key_indices_.end()) {
      at = key_indices_.emplace(key, static_cast<std::uint32_t>(keys_.size())).first;
      keys_.emplace_back(key);
    }
    const auto [value_at, is_new] = value_indices_.try_emplace(value, static_cast<std::uint32_t>(values_.size()));
    if (is_new) values_.push_back(value);
    tags.push_back(at->second);
    tags.push_back(value_at->second);
  }
  std::string feature;
  PutInteger(1, id, feature);
  PutPacked(2, tags, feature);
  PutInteger(3, static_cast<std::uint64_t>(type), feature);
  PutPacked(4, geometry, feature);
  PutBytes(2, feature, features_);
}

void TileLayer::AddPoint(std::uint64_t id, TilePoint point, const TileAttributes& attributes) {
  const std::uint32_t geometry[] = {Command(kMoveTo, 1), ZigZag(point.x), ZigZag(point.y)};
  AddFeature(id, kPointType, geometry, attributes);
}

void TileLayer::AddPolygon(std::uint64_t id, std::span<const TilePoint> ring, const TileAttributes& attributes) {
  // Corners that fall on each other would be segments of no length, which the specification advises against.
  std::vector<TilePoint> corners;
  for (const TilePoint& corner : ring) {
    if (corners.empty() || corner != corners.back()) corners.push_back(corner);
  }
  while (corners.size() > 1 && corners.front() == corners.back()) corners.pop_back();
  const std::int64_t area = DoubleArea(corners);
  if (corners.size() < 3 || area == 0) return;
  if (area < 0) corners = {corners.rbegin(), corners.rend()};
  std::vector<std::uint32_t> geometry;
  TilePoint cursor;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (i == 0) geometry.push_back(Command(kMoveTo, 1));
    if (i == 1) geometry.push_back(Command(kLineTo, static_cast<std::uint32_t>(corners.size() - 1)));
    geometry.push_back(ZigZag(corners[i].x - cursor.x));
    geometry.push_back(ZigZag(corners[i].y - cursor.y));
    cursor = corners[i];
  }
  geometry.push_back(Command(kClosePath, 1));
  AddFeature(id, kPolygonType, geometry, attributes);
}

std::string TileLayer::Encode() const {
  if (features_.empty()) return {};
  std::string layer;
  PutBytes(1, name_, layer);
  layer += features_;
  for (const std::string& key : keys_) PutBytes(3, key, layer);
  for (const TileValue& value : values_) PutBytes(4, EncodeValue(value), layer);
  PutInteger(5, extent_, layer);
  PutInteger(15, 2, layer);  // version
  return layer;
}

std::string EncodeTile(std::span<const TileLayer> layers) {
  std::string tile;
  for (const TileLayer& layer : layers) {
    const std::string bytes = layer.Encode();
    if (!bytes.empty()) PutBytes(3, bytes, tile);
  }
  return tile;
}

}  // namespace victorious

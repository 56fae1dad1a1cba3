// Reads vector tiles back, straight from the specification (Mapbox Vector Tile 2.1), for the tests of what writes them.
#pragma once

#include <bit>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace victorious::testing {

using ReadValue = std::variant<std::string, double, std::int64_t, bool>;

struct ReadFeature {
  std::uint64_t id = 0;
  int type = 0;
  std::vector<std::uint32_t> tags;
  std::vector<std::uint32_t> geometry;
};

struct ReadLayer {
  std::string name;
  std::uint32_t version = 0;
  std::uint32_t extent = 0;
  std::vector<std::string> keys;
  std::vector<ReadValue> values;
  std::vector<ReadFeature> features;

  [[nodiscard]] std::optional<ReadValue> Find(std::size_t feature, std::string_view key) const {
    const std::vector<std::uint32_t>& tags = features.at(feature).tags;
    for (std::size_t i = 0; i + 1 < tags.size(); i += 2) {
      if (keys.at(tags[i]) == key) return values.at(tags[i + 1]);
    }
    return std::nullopt;
  }
};

class ProtobufReader {
 public:
  explicit ProtobufReader(std::string_view bytes) : bytes_(bytes) {}

  [[nodiscard]] bool AtEnd() const { return bytes_.empty(); }

  std::uint64_t Varint() {
    std::uint64_t value = 0;
    for (int shift = 0; shift < 64; shift += 7) {
      const auto byte = static_cast<unsigned char>(Take(1)[0]);
      value |= std::uint64_t{byte & 0x7fU} << shift;
      if (byte < 0x80) return value;
    }
    throw std::runtime_error("a number of more than ten bytes");
  }
  std::string_view Bytes() { return Take(static_cast<std::size_t>(Varint())); }
  double Double() {
    std::uint64_t bits = 0;
    const std::string_view bytes = Take(8);
    for (std::size_t i = 0; i < 8; ++i) bits |= std::uint64_t{static_cast<unsigned char>(bytes[i])} << (8 * i);
    return std::bit_cast<double>(bits);
  }
  std::vector<std::uint32_t> Packed() {
    ProtobufReader inner(Bytes());
    std::vector<std::uint32_t> numbers;
    while (!inner.AtEnd()) numbers.push_back(static_cast<std::uint32_t>(inner.Varint()));
    return numbers;
  }

 private:
  std::string_view Take(std::size_t count) {
    if (count > bytes_.size()) throw std::runtime_error("the tile ends early");
    const std::string_view taken = bytes_.substr(0, count);
    bytes_.remove_prefix(count);
    return taken;
  }

  std::string_view bytes_;
};

inline ReadValue ReadTileValue(std::string_view bytes) {
  ProtobufReader reader(bytes);
  switch (reader.Varint()) {
    case 1 << 3 | 2:
      return std::string(reader.Bytes());
    case 3 << 3 | 1:
      return reader.Double();
    case 6 << 3 | 0: {
      const std::uint64_t zigzag = reader.Varint();
      return static_cast<std::int64_t>(zigzag >> 1) ^ -static_cast<std::int64_t>(zigzag & 1);
    }
    case 7 << 3 | 0:
      return reader.Varint() != 0;
    default:
      throw std::runtime_error("a value of another type");
  }
}

inline ReadFeature ReadTileFeature(std::string_view bytes) {
  ProtobufReader reader(bytes);
  ReadFeature feature;
  while (!reader.AtEnd()) {
    switch (reader.Varint()) {
      case 1 << 3 | 0:
        feature.id = reader.Varint();
        break;
      case 2 << 3 | 2:
        feature.tags = reader.Packed();
        break;
      case 3 << 3 | 0:
        feature.type = static_cast<int>(reader.Varint());
        break;
      case 4 << 3 | 2:
        feature.geometry = reader.Packed();
        break;
      default:
        throw std::runtime_error("a field that features do not have");
    }
  }
  return feature;
}

inline std::vector<ReadLayer> ReadTile(std::string_view bytes) {
  ProtobufReader tile(bytes);
  std::vector<ReadLayer> layers;
  while (!tile.AtEnd()) {
    if (tile.Varint() != (3 << 3 | 2)) throw std::runtime_error("a field that tiles do not have");
    ProtobufReader reader(tile.Bytes());
    ReadLayer layer;
    while (!reader.AtEnd()) {
      switch (reader.Varint()) {
        case 15 << 3 | 0:
          layer.version = static_cast<std::uint32_t>(reader.Varint());
          break;
        case 1 << 3 | 2:
          layer.name = reader.Bytes();
          break;
        case 2 << 3 | 2:
          layer.features.push_back(ReadTileFeature(reader.Bytes()));
          break;
        case 3 << 3 | 2:
          layer.keys.emplace_back(reader.Bytes());
          break;
        case 4 << 3 | 2:
          layer.values.push_back(ReadTileValue(reader.Bytes()));
          break;
        case 5 << 3 | 0:
          layer.extent = static_cast<std::uint32_t>(reader.Varint());
          break;
        default:
          throw std::runtime_error("a field that layers do not have");
      }
    }
    layers.push_back(std::move(layer));
  }
  return layers;
}

}  // namespace victorious::testing

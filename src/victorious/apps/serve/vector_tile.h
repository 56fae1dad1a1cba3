// Writes a Mapbox Vector Tile (specification 2.1): layers of points and polygons with attributes, in Protocol Buffers.
// object_tiles.h makes the tiles of the map from it.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace victorious {

/// In units of the tile: `extent` of them on a side, x to the right, y down. May lie beyond the tile.
struct TilePoint {
  std::int32_t x = 0;
  std::int32_t y = 0;

  bool operator==(const TilePoint&) const = default;
};

using TileValue = std::variant<std::string, double, std::int64_t, bool>;
using TileAttributes = std::vector<std::pair<std::string_view, TileValue>>;

/// One layer. A layer without features is left out of the tile, as the specification asks.
class TileLayer {
 public:
  /// @param extent  units on a side of the tile
  TileLayer(std::string_view name, std::uint32_t extent) : name_(name), extent_(extent) {}

  void AddPoint(std::uint64_t id, TilePoint point, const TileAttributes& attributes);

  /// @param ring  at least 3 corners, without repeating the first. It is turned clockwise on screen, as exterior rings
  ///              are; a ring without area is left out.
  void AddPolygon(std::uint64_t id, std::span<const TilePoint> ring, const TileAttributes& attributes);

  [[nodiscard]] std::string Encode() const;

 private:
  void AddFeature(std::uint64_t id, int type, std::span<const std::uint32_t> geometry,
                  const TileAttributes& attributes);

  std::string name_;
  std::uint32_t extent_;
  std::string features_;
  std::vector<std::string> keys_;
  std::map<std::string, std::uint32_t, std::less<>> key_indices_;
  std::vector<TileValue> values_;
  std::map<TileValue, std::uint32_t> value_indices_;
};

/// The tile of these layers; empty if none has a feature.
[[nodiscard]] std::string EncodeTile(std::span<const TileLayer> layers);

}  // namespace victorious

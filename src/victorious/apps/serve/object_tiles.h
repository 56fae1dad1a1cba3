// The objects of an index as vector tiles (vector_tile.h) for the map: Web Mercator, tile z/x/y from the north-west.
//
// A tile that holds few objects has each of them, with its 90 % ellipse where that is large enough to be seen. A tile
// that holds many has clusters: the objects of each of 16 x 16 cells as one point at their mean, so that no tile has
// more than 256 of them. In tiles of the last zoom level only the best objects remain.
#pragma once

#include <cstdint>
#include <string>

#include "victorious/base/error.h"
#include "victorious/store/triage_store.h"

namespace victorious {

struct TileAddress {
  int zoom = 0;
  std::int64_t x = 0;
  std::int64_t y = 0;
};

inline constexpr int kMaxTileZoom = 18;  ///< the map enlarges tiles of this level beyond it

/// Objects that a tile shows one by one.
inline constexpr int kMaxTileObjects = 300;
/// The same in a tile of the last level, where a cluster could not be opened by zooming in.
inline constexpr int kMaxLastTileObjects = 2000;

/// Layers: `objects` (points: id, model, score, verdict, matches, heading), `ellipses` (polygons: the same without
/// heading), `clusters` (points: count, label: the count in two digits, matches, best: the score of the best).
/// `matches`: whether the object matches the query; of a cluster, how many do. Cost: proportional to the objects in the
/// tile.
[[nodiscard]] Expected<std::string> MakeObjectTile(TriageStore& store, const TileAddress& tile,
                                                   const ObjectQuery& query);

}  // namespace victorious

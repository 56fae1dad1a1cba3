#include "victorious/apps/serve/object_tiles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "victorious/apps/serve/api_json.h"
#include "victorious/apps/serve/vector_tile.h"
#include "victorious/base/enum_text.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/web_mercator.h"

namespace victorious {
namespace {

constexpr int kExtent = 4096;
constexpr int kCells = 16;         // on a side of a tile
constexpr double kMargin = 0.5;    // of a tile's side, on each of its sides: ellipses reach over from there
constexpr double kMinEllipse = 8;  // half the longer axis in units of the tile; a smaller one is hidden by the point
constexpr double kEarthRadius_m = 6'378'137;

// From the whole world's square, 0 to 1 eastwards and southwards.
double LongitudeOf(double u) { return kPi * (2 * u - 1); }
double LatitudeOf(double v) { return std::atan(std::sinh(kPi * (1 - 2 * v))); }

GeoBox RegionOf(const TileAddress& tile, double margin) {
  const double side = std::ldexp(1.0, -tile.zoom);
  const auto clamp = [](double value) { return std::clamp(value, 0.0, 1.0); };
  const auto x = static_cast<double>(tile.x);
  const auto y = static_cast<double>(tile.y);
  return {LatitudeOf(clamp((y + 1 + margin) * side)), LongitudeOf(clamp((x - margin) * side)),
          LatitudeOf(clamp((y - margin) * side)), LongitudeOf(clamp((x + 1 + margin) * side))};
}

// Units of the tile, not rounded.
std::pair<double, double> PositionIn(const TileAddress& tile, double latitude_rad, double longitude_rad) {
  const double tiles = std::ldexp(1.0, tile.zoom);
  return {(MercatorEast(longitude_rad) * tiles - static_cast<double>(tile.x)) * kExtent,
          (MercatorSouth(latitude_rad) * tiles - static_cast<double>(tile.y)) * kExtent};
}

TilePoint Round(std::pair<double, double> position) {
  return {static_cast<std::int32_t>(std::lround(position.first)),
          static_cast<std::int32_t>(std::lround(position.second))};
}

bool IsInside(std::pair<double, double> position) {
  return position.first >= 0 && position.first < kExtent && position.second >= 0 && position.second < kExtent;
}

struct TileCell {
  std::int64_t count = 0;
  std::int64_t matches = 0;
  double sum_x = 0;
  double sum_y = 0;
  double best = 0;
};

// At most two digits, so that a map has few labels to draw: 7, 43, 130, 2.4k, 50k.
std::string ShortCount(std::int64_t count) {
  const auto round = [](std::int64_t number, std::int64_t unit) { return (number + unit / 2) / unit * unit; };
  if (count < 100) return fmt::format("{}", count);
  if (count < 995) return fmt::format("{}", round(count, 10));
  if (count < 9'950) return fmt::format("{:.1f}k", static_cast<double>(count) / 1000);
  if (count < 999'500) return fmt::format("{}k", round(count, 1000) / 1000);
  return fmt::format("{}M", round(count, 1'000'000) / 1'000'000);
}

// Joins cells whose means lie closer than their circles are wide: a group that the border of two cells cuts is one.
void MergeNeighbours(std::array<TileCell, kCells * kCells>& cells) {
  constexpr double kMinDistance = 0.9 * kExtent / kCells;
  const auto mean = [](const TileCell& cell) {
    return std::pair(cell.sum_x / static_cast<double>(cell.count), cell.sum_y / static_cast<double>(cell.count));
  };
  for (int i = 0; i < kCells * kCells; ++i) {
    // The four neighbours that come later in the order of the loop.
    for (const auto& [right, down] : {std::pair(1, 0), {-1, 1}, {0, 1}, {1, 1}}) {
      const int column = i % kCells + right;
      const int row = i / kCells + down;
      if (column < 0 || column >= kCells || row >= kCells) continue;
      TileCell& here = cells[static_cast<std::size_t>(i)];
      TileCell& other = cells[static_cast<std::size_t>(row * kCells + column)];
      if (here.count == 0 || other.count == 0) continue;
      const auto [x, y] = mean(here);
      const auto [other_x, other_y] = mean(other);
      if (std::hypot(x - other_x, y - other_y) >= kMinDistance) continue;
      TileCell& larger = here.count >= other.count ? here : other;
      TileCell& smaller = here.count >= other.count ? other : here;
      larger.count += smaller.count;
      larger.matches += smaller.matches;
      larger.sum_x += smaller.sum_x;
      larger.sum_y += smaller.sum_y;
      larger.best = std::max(larger.best, smaller.best);
      smaller = {};
    }
  }
}

TileAttributes AttributesOf(const PlacedObject& placed) {
  return {{"id", placed.id},
          {"model", placed.model},
          {"score", placed.score},
          {"verdict", std::string(placed.verdict ? ToText(*placed.verdict) : "")},
          {"matches", placed.matches}};
}

// The 90 % ellipse, if it is large enough to be seen.
void AddEllipse(const TileAddress& tile, const PlacedObject& placed, const Geolocation& place, TileLayer& layer) {
  constexpr int kCorners = 32;
  const EllipseAxes axes = ComputeEllipseAxes(place.covariance_enu_m2);
  const double units_per_m =
      kExtent * std::ldexp(1.0, tile.zoom) / (2 * kPi * kEarthRadius_m * std::max(std::cos(placed.latitude_rad), 1e-6));
  if (!(axes.semi_major_m * units_per_m >= kMinEllipse)) return;
  // One that reaches further than the tiles beside it know would be cut at their border: the map draws it when the
  // object is selected.
  if (axes.semi_major_m * units_per_m > kMargin * kExtent) return;
  const auto [x, y] = PositionIn(tile, placed.latitude_rad, placed.longitude_rad);
  std::array<TilePoint, kCorners> ring;
  for (int i = 0; i < kCorners; ++i) {
    const double angle = 2 * kPi * i / kCorners;
    const double along = axes.semi_major_m * std::cos(angle) * units_per_m;
    const double across = axes.semi_minor_m * std::sin(angle) * units_per_m;
    const double east = along * std::sin(axes.azimuth_rad) + across * std::cos(axes.azimuth_rad);
    const double north = along * std::cos(axes.azimuth_rad) - across * std::sin(axes.azimuth_rad);
    ring[static_cast<std::size_t>(i)] = Round({x + east, y - north});
  }
  layer.AddPolygon(static_cast<std::uint64_t>(placed.id), ring, AttributesOf(placed));
}

Expected<std::string> MakeSingles(TriageStore& store, const TileAddress& tile, std::vector<PlacedObject> objects) {
  std::array layers = {TileLayer("ellipses", kExtent), TileLayer("objects", kExtent)};
  constexpr std::size_t kMaxAtOnce = 1000;
  for (std::size_t first = 0; first < objects.size(); first += kMaxAtOnce) {
    const std::span<const PlacedObject> part =
        std::span(objects).subspan(first, std::min(kMaxAtOnce, objects.size() - first));
    std::vector<std::int64_t> ids;
    for (const PlacedObject& placed : part) ids.push_back(placed.id);
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<PlacedShape> shapes, store.PlaceShapes(ids));
    for (const PlacedObject& placed : part) {
      const auto shape = std::ranges::lower_bound(shapes, placed.id, {}, &PlacedShape::id);
      if (shape == shapes.end() || shape->id != placed.id) continue;  // removed meanwhile
      AddEllipse(tile, placed, shape->place, layers[0]);
      const auto position = PositionIn(tile, placed.latitude_rad, placed.longitude_rad);
      if (!IsInside(position)) continue;
      TileAttributes attributes = AttributesOf(placed);
      if (shape->heading_rad) attributes.emplace_back("heading", DegreesFromRadians(*shape->heading_rad));
      layers[1].AddPoint(static_cast<std::uint64_t>(placed.id), Round(position), attributes);
    }
  }
  return EncodeTile(layers);
}

Expected<std::string> MakeClusters(const std::vector<PlaceCell>& sums) {
  std::array<TileCell, kCells * kCells> cells{};
  for (const PlaceCell& one : sums) {
    cells[static_cast<std::size_t>(one.row * kCells + one.column)] = {.count = one.count,
                                                                      .matches = one.matches,
                                                                      .sum_x = one.sum_x * kExtent,
                                                                      .sum_y = one.sum_y * kExtent,
                                                                      .best = one.best};
  }
  MergeNeighbours(cells);
  TileLayer clusters("clusters", kExtent);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const TileCell& cell = cells[i];
    if (cell.count == 0) continue;
    const auto count = static_cast<double>(cell.count);
    clusters.AddPoint(
        i + 1, Round({cell.sum_x / count, cell.sum_y / count}),
        {{"count", cell.count}, {"label", ShortCount(cell.count)}, {"matches", cell.matches}, {"best", cell.best}});
  }
  return EncodeTile({&clusters, 1});
}

}  // namespace

Expected<std::string> MakeObjectTile(TriageStore& store, const TileAddress& tile, const ObjectQuery& query) {
  const std::size_t limit = tile.zoom >= kMaxTileZoom ? kMaxLastTileObjects : kMaxTileObjects;
  if (tile.zoom < kMaxTileZoom) {
    const double side = std::ldexp(1.0, -tile.zoom);
    const MapGrid grid{.west = static_cast<double>(tile.x) * side,
                       .north = static_cast<double>(tile.y) * side,
                       .side = side,
                       .cells = kCells};
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<PlaceCell> sums, store.SumPlaces(grid, query));
    std::int64_t inside = 0;
    for (const PlaceCell& one : sums) inside += one.count;
    if (inside > static_cast<std::int64_t>(limit)) return MakeClusters(sums);
  }
  std::vector<PlacedObject> near;  // with those of the margin
  const auto is_better = [](const PlacedObject& a, const PlacedObject& b) {
    return std::pair(-a.score, a.id) < std::pair(-b.score, b.id);
  };
  VICTORIOUS_RETURN_IF_ERROR(store.VisitPlaces(RegionOf(tile, kMargin), query, [&](const PlacedObject& placed) {
    near.push_back(placed);
    return true;
  }));
  // Neighbours beyond the limit have no room for ellipses anyway.
  const std::size_t kept = std::min(near.size(), 4 * limit);
  std::ranges::partial_sort(near, near.begin() + static_cast<std::ptrdiff_t>(kept), is_better);
  near.resize(kept);
  return MakeSingles(store, tile, std::move(near));
}

}  // namespace victorious

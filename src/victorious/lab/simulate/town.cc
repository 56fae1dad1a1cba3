#include "victorious/lab/simulate/town.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "victorious/base/random.h"
#include "victorious/lab/simulate/parcel.h"

namespace victorious {
namespace {

using Eigen::Vector2d;

bool IsMultiple(int value, int of) { return value % of == 0; }

// The number of quarter turns after which a square's front faces an adjacent street; std::nullopt without a street.
std::optional<int> TurnsToStreet(int column, int row, const SceneTown& town) {
  if (IsMultiple(row + 1, town.rows_per_street)) return 0;
  if (IsMultiple(row - 1, town.rows_per_street)) return 2;
  if (IsMultiple(column + 1, town.columns_per_street)) return 1;
  if (IsMultiple(column - 1, town.columns_per_street)) return 3;
  return std::nullopt;
}

Random MakeSquareRandom(int column, int row, std::uint64_t seed) {
  constexpr std::uint64_t kColumns = 4096;
  const auto square = static_cast<std::uint64_t>(column + 2048) + kColumns * static_cast<std::uint64_t>(row + 2048);
  return Random(MixSeed(seed, square));
}

void PlanSquare(int column, int row, const SceneTown& town, std::vector<Placement>& placements) {
  const Vector2d middle_m = kSquareSideM * Vector2d(column, row);
  const auto parcel = [&](int turns) {
    return Parcel(middle_m, turns, MakeSquareRandom(column, row, town.seed), town.density, placements);
  };
  const auto is_here = [&](const SceneTile& tile) { return tile.column == column && tile.row == row; };
  if (const auto chosen = std::ranges::find_if(town.tiles, is_here); chosen != town.tiles.end()) {
    Parcel square = parcel(chosen->turns);
    return FurnishTile(square, chosen->tile);
  }
  const bool along = IsMultiple(column, town.columns_per_street);
  const bool across = IsMultiple(row, town.rows_per_street);
  const std::optional<int> to_street = TurnsToStreet(column, row, town);
  Parcel square = parcel(along || across ? (along ? 0 : 1) : to_street.value_or(0));
  if (along && across) return FurnishJunction(square);
  if (along || across) return FurnishStreet(square);
  FurnishSquare(square, to_street.has_value());
}

// The grass below all tiles and lots, which extends beyond the town. Its squares have a whole number of texture
// periods, so that there are no seams. They are small, so that no visible square extends to the camera: the range of
// depths would then exceed the resolution of the depth buffer.
void LayUnderlay(const SceneTown& town, std::vector<Placement>& placements) {
  constexpr double kSideM = 40;
  constexpr double kBeyondM = 300;
  constexpr double kBottomM = -0.06;  // far enough below the tiles to avoid z-fighting
  const auto first = [](int square) { return std::floor((kSquareSideM * square - kBeyondM) / kSideM) * kSideM; };
  for (double y = first(town.squares[1]); y < kSquareSideM * town.squares[3] + kBeyondM; y += kSideM) {
    for (double x = first(town.squares[0]); x < kSquareSideM * town.squares[2] + kBeyondM; x += kSideM) {
      placements.push_back({.asset = "town/ground/grass", .place_m = {x, y}, .bottom_m = kBottomM, .side_m = kSideM});
    }
  }
}

bool IsGround(const Placement& placement) { return placement.side_m > 0 || placement.asset.starts_with("town/tiles/"); }

bool IsInside(const Vector2d& place_m, const Placement& building, const Vector2d& size_m) {
  const Vector2d away = place_m - building.place_m;
  const Vector2d front(std::sin(building.heading_rad), std::cos(building.heading_rad));
  const double along = std::abs(away.dot(front));
  const double across = std::abs(away.dot(Vector2d(front.y(), -front.x())));
  return along < size_m.x() / 2 && across < size_m.y() / 2;
}

}  // namespace

std::vector<Placement> LayOutTown(const SceneTown& town) {
  std::vector<Placement> placements;
  LayUnderlay(town, placements);
  for (int row = town.squares[1]; row <= town.squares[3]; ++row) {
    for (int column = town.squares[0]; column <= town.squares[2]; ++column) {
      PlanSquare(column, row, town, placements);
    }
  }
  return placements;
}

std::vector<bool> FindUnobstructed(std::span<const Placement> town, std::span<const Vector2d> sizes_m,
                                   std::span<const ClearZone> clear) {
  std::vector<bool> stands(town.size(), true);
  std::vector<std::size_t> buildings;
  for (std::size_t i = 0; i < town.size(); ++i) {
    if (IsGround(town[i])) continue;
    stands[i] = std::ranges::none_of(clear, [&](const ClearZone& ground) {
      return (ground.centre_m - town[i].place_m).norm() < ground.radius_m + sizes_m[i].norm() / 2;
    });
    if (stands[i] && town[i].asset.starts_with("town/buildings/")) buildings.push_back(i);
  }
  for (std::size_t i = 0; i < town.size(); ++i) {
    if (IsGround(town[i])) continue;
    if (std::ranges::any_of(buildings, [&](std::size_t building) {
          return building != i && IsInside(town[i].place_m, town[building], sizes_m[building]);
        })) {
      stands[i] = false;
    }
  }
  return stands;
}

}  // namespace victorious

#include "victorious/lab/simulate/town.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "victorious/geometry/angles.h"
#include "victorious/object/mesh/load_mesh.h"

namespace victorious {
namespace {

using Eigen::Vector2d;

bool StandsAbove(const Placement& placement) {
  return placement.side_m == 0 && !placement.asset.starts_with("town/tiles/");
}

long CountOf(const std::vector<Placement>& placements, std::string_view start) {
  return std::ranges::count_if(placements, [&](const Placement& p) { return p.asset.starts_with(start); });
}

const Placement* TileAt(const std::vector<Placement>& placements, const Vector2d& middle_m) {
  const auto at = std::ranges::find_if(placements, [&](const Placement& p) {
    return p.asset.starts_with("town/tiles/") && (p.place_m - middle_m).norm() < 1e-9;
  });
  return at == placements.end() ? nullptr : &*at;
}

TEST(Town, IsDeterministicBySeed) {
  const auto first = LayOutTown({.seed = 5});
  const auto again = LayOutTown({.seed = 5});
  const auto other = LayOutTown({.seed = 6});
  ASSERT_EQ(first.size(), again.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].asset, again[i].asset);
    EXPECT_EQ(first[i].place_m, again[i].place_m);
  }
  EXPECT_TRUE(first.size() != other.size() || first.back().place_m != other.back().place_m);
}

TEST(Town, HasRoadsBuildingsTreesCarsAndProps) {
  const auto town = LayOutTown({});
  for (const char* kind : {"town/tiles/road_", "town/buildings/", "town/trees/", "town/cars/", "town/props/"}) {
    EXPECT_GT(CountOf(town, kind), 10) << kind;
  }
}

TEST(Town, StreetsAreConnectedOnTheGrid) {
  const auto town = LayOutTown({.columns_per_street = 4, .rows_per_street = 3});
  for (int column = -5; column <= 5; ++column) {
    for (int row = -4; row <= 4; ++row) {
      const Placement* tile = TileAt(town, kSquareSideM * Vector2d(column, row));
      const bool is_street = tile != nullptr && tile->asset.starts_with("town/tiles/road_");
      EXPECT_EQ(is_street, column % 4 == 0 || row % 3 == 0) << column << ", " << row;
      const bool is_junction = is_street && tile->asset == "town/tiles/road_junction";
      EXPECT_EQ(is_junction, column % 4 == 0 && row % 3 == 0) << column << ", " << row;
    }
  }
}

TEST(Town, DensityIncreasesBuildings) {
  const auto count = [](double density) {
    return std::ranges::count_if(LayOutTown({.density = density}), &StandsAbove);
  };
  EXPECT_LT(count(0.2), count(0.5));
  EXPECT_LT(count(0.5), count(1.0));
}

// The size of each placement's mesh along its front and across; zero for ground.
std::vector<Vector2d> SizesOf(const std::vector<Placement>& town) {
  static std::map<std::string, Vector2d> known;  // cached, because loading is slow
  std::vector<Vector2d> sizes_m;
  for (const Placement& placement : town) {
    const auto [at, is_new] = known.emplace(placement.asset, Vector2d::Zero());
    if (is_new && placement.side_m == 0) {
      const auto loaded = LoadMesh(std::filesystem::path(VICTORIOUS_ASSETS) / (placement.asset + ".glb"));
      EXPECT_TRUE(loaded) << loaded.error().message;
      if (loaded) at->second = BoundingBox(loaded->mesh).sizes().head<2>();
    }
    sizes_m.push_back(at->second);
  }
  return sizes_m;
}

TEST(Town, ClearZonesAreEmpty) {
  const std::vector<ClearZone> clear = {{{0, 0}, 15}, {{24, 24}, 8}, {{30, -40}, 3}};
  const auto town = LayOutTown({.density = 1});
  const std::vector<Vector2d> sizes_m = SizesOf(town);
  const auto stands_on = [&](std::size_t i, const ClearZone& ground) {
    return (town[i].place_m - ground.centre_m).norm() < ground.radius_m + sizes_m[i].norm() / 2;
  };
  const std::vector<bool> stays = FindUnobstructed(town, sizes_m, clear);
  int moved_away = 0;
  for (std::size_t i = 0; i < town.size(); ++i) {
    if (!StandsAbove(town[i])) {
      EXPECT_TRUE(stays[i]) << town[i].asset;
      continue;
    }
    for (const ClearZone& ground : clear) {
      EXPECT_FALSE(stays[i] && stands_on(i, ground)) << town[i].asset;
      moved_away += stands_on(i, ground) ? 1 : 0;
    }
  }
  EXPECT_GT(moved_away, 10);
}

TEST(Town, ClearZonesConsiderTheBuildingLength) {
  const std::vector<Placement> town = {{.asset = "town/buildings/warehouse"}};
  const std::vector<Vector2d> sizes_m = {{28.4, 18.6}};
  EXPECT_EQ(FindUnobstructed(town, sizes_m, std::vector<ClearZone>{{{18, 0}, 2}}), std::vector{false});
  EXPECT_EQ(FindUnobstructed(town, sizes_m, std::vector<ClearZone>{{{20, 0}, 2}}), std::vector{true});
}

TEST(Town, NothingOverlapsABuilding) {
  int left_out = 0;
  for (const std::uint64_t seed : {1, 2, 3, 18}) {
    const auto town = LayOutTown({.seed = seed, .density = 1});
    const std::vector<Vector2d> sizes_m = SizesOf(town);
    const std::vector<bool> stays = FindUnobstructed(town, sizes_m, {});
    left_out += static_cast<int>(std::ranges::count(stays, false));
    int compared = 0;
    for (std::size_t b = 0; b < town.size(); ++b) {
      if (!town[b].asset.starts_with("town/buildings/")) continue;
      EXPECT_TRUE(stays[b]) << town[b].asset;
      const Eigen::Rotation2Dd to_building(town[b].heading_rad - kPi / 2);
      for (std::size_t i = 0; i < town.size(); ++i) {
        if (i == b || !stays[i] || !StandsAbove(town[i])) continue;
        const Vector2d place = (to_building * (town[i].place_m - town[b].place_m)).cwiseAbs();
        EXPECT_FALSE((place.array() < sizes_m[b].array() / 2).all()) << town[i].asset << " in " << town[b].asset;
        ++compared;
      }
    }
    EXPECT_GT(compared, 1000);
  }
  EXPECT_GT(left_out, 4);  // LayOutTown alone places trees there
}

TEST(Town, UsesTheGivenTiles) {
  const auto town = LayOutTown({.tiles = {{.tile = "apron", .column = 2, .row = 1, .turns = 1}}});
  const Placement* tile = TileAt(town, {48, 24});
  ASSERT_NE(tile, nullptr);
  EXPECT_EQ(tile->asset, "town/tiles/apron");
  EXPECT_NEAR(tile->heading_rad, 1.5708, 1e-3);
}

}  // namespace
}  // namespace victorious

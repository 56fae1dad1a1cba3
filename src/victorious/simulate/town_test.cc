#include "victorious/simulate/town.h"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

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

TEST(Town, IsTheSeeds) {
  const auto first = LayOutTown({.seed = 5}, {});
  const auto again = LayOutTown({.seed = 5}, {});
  const auto other = LayOutTown({.seed = 6}, {});
  ASSERT_EQ(first.size(), again.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].asset, again[i].asset);
    EXPECT_EQ(first[i].place_m, again[i].place_m);
  }
  EXPECT_TRUE(first.size() != other.size() || first.back().place_m != other.back().place_m);
}

TEST(Town, HasWhatATownHas) {
  const auto town = LayOutTown({}, {});
  for (const char* kind : {"town/tiles/road_", "town/buildings/", "town/trees/", "town/cars/", "town/props/"}) {
    EXPECT_GT(CountOf(town, kind), 10) << kind;
  }
}

TEST(Town, StreetsRunOnTheGridAndMeet) {
  const auto town = LayOutTown({.columns_per_street = 4, .rows_per_street = 3}, {});
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

TEST(Town, DensityFillsIt) {
  const auto count = [](double density) {
    return std::ranges::count_if(LayOutTown({.density = density}, {}), &StandsAbove);
  };
  EXPECT_LT(count(0.2), count(0.5));
  EXPECT_LT(count(0.5), count(1.0));
}

TEST(Town, KeepsClearWhatItIsTold) {
  const std::vector<KeptClear> clear = {{{0, 0}, 15}, {{24, 24}, 8}};
  ASSERT_TRUE(std::ranges::any_of(LayOutTown({.density = 1}, {}),
                                  [](const Placement& p) { return StandsAbove(p) && p.place_m.norm() < 15; }));
  for (const Placement& placement : LayOutTown({.density = 1}, clear)) {
    if (!StandsAbove(placement)) continue;
    for (const KeptClear& free : clear) {
      EXPECT_GT((placement.place_m - free.centre_m).norm(), free.radius_m) << placement.asset;
    }
  }
}

TEST(Town, TakesTheTilesThatAreChosen) {
  const auto town = LayOutTown({.tiles = {{.tile = "apron", .column = 2, .row = 1, .turns = 1}}}, {});
  const Placement* tile = TileAt(town, {48, 24});
  ASSERT_NE(tile, nullptr);
  EXPECT_EQ(tile->asset, "town/tiles/apron");
  EXPECT_NEAR(tile->heading_rad, 1.5708, 1e-3);
}

}  // namespace
}  // namespace victorious

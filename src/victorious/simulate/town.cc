#include "victorious/simulate/town.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

using Eigen::Vector2d;

int FloorMod(int value, int divisor) { return ((value % divisor) + divisor) % divisor; }

class TownPlanner {
 public:
  TownPlanner(const SceneTown& town, std::span<const KeptClear> clear) : town_(town), clear_(clear) {}

  std::vector<Placement> Plan() {
    for (int row = town_.squares[1]; row <= town_.squares[3]; ++row) {
      for (int column = town_.squares[0]; column <= town_.squares[2]; ++column) PlanSquare(column, row);
    }
    return std::move(placements_);
  }

 private:
  void PlanSquare(int column, int row) {
    const Vector2d middle = kSquareSide_m * Vector2d(column, row);
    const auto chosen = std::ranges::find_if(
        town_.tiles, [&](const SceneTile& tile) { return tile.column == column && tile.row == row; });
    if (chosen != town_.tiles.end()) {
      LayTile(chosen->tile, middle, chosen->turns);
      return;
    }
    const bool along = FloorMod(column, town_.columns_per_street) == 0;
    const bool across = FloorMod(row, town_.rows_per_street) == 0;
    if (along && across) {
      LayTile("road_junction", middle, 0);
    } else if (along || across) {
      LayTile("road_straight", middle, across ? 1 : 0);
    } else {
      LayTile("parking", middle, 0);
    }
  }

  void LayTile(std::string_view tile, const Vector2d& middle, int turns) {
    placements_.push_back({fmt::format("town/tiles/{}", tile), middle, 0, turns * kPi / 2});
  }

  const SceneTown& town_;
  std::span<const KeptClear> clear_;
  std::vector<Placement> placements_;
};

}  // namespace

std::vector<Placement> LayOutTown(const SceneTown& town, std::span<const KeptClear> clear) {
  return TownPlanner(town, clear).Plan();
}

}  // namespace victorious

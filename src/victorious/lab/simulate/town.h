// Generates a random town: streets on a grid, and between them squares with houses, halls, car parks, parks and yards,
// with trees, parked cars and props. The same options give the same town.
//
// Squares are 24 m wide, the size of the shipped tiles. Every columns_per_street-th column and rows_per_street-th row
// is a street. Each square has its own random generator, so that a change to one does not affect the others.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "victorious/lab/simulate/scene.h"

namespace victorious {

inline constexpr double kSquareSideM = 24;

/// An asset and its pose in the town frame.
struct Placement {
  std::string asset;                                  ///< a file below the assets' folder, without its extension
  Eigen::Vector2d place_m = Eigen::Vector2d::Zero();  ///< centre of its bounding box
  double bottom_m = 0;                                ///< height of its lowest point
  double heading_rad = 0;                             ///< clockwise from the town's y axis
  double side_m = 0;  ///< ground material (town/ground/…): side of the square that it covers; 0: the asset is a mesh
};

/// A disc of ground that must stay free: the position of an object, or a part of its path.
struct ClearZone {
  Eigen::Vector2d centre_m = Eigen::Vector2d::Zero();
  double radius_m = 0;
};

/// All placements of the town and of the open ground around it.
[[nodiscard]] std::vector<Placement> LayOutTown(const SceneTown& town);

/// For each placement, whether it can stay. Rejects a placement whose circumscribed circle (radius: half its diagonal)
/// overlaps a clear zone, or whose centre lies inside a building. Ground always stays.
/// @param sizes_m  size of each placement's bounding box: along its front, across
[[nodiscard]] std::vector<bool> FindUnobstructed(std::span<const Placement> town,
                                                 std::span<const Eigen::Vector2d> sizes_m,
                                                 std::span<const ClearZone> clear);

}  // namespace victorious

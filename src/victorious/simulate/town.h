// A town by lot: streets on a grid, and between them squares with houses, halls, car parks, parks and yards, furnished
// with trees, parked cars and what lies about. The same options give the same town.
//
// Squares are 24 m wide, as the shipped tiles are. Every columns_per_street-th column and rows_per_street-th row is a
// street. Each square has a lottery of its own, so that a change in one leaves the others as they are.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "victorious/simulate/scene.h"

namespace victorious {

inline constexpr double kSquareSideM = 24;

/// A thing and where it stands in the town's frame.
struct Placement {
  std::string asset;                                  ///< a file below the assets' folder, without its ending
  Eigen::Vector2d place_m = Eigen::Vector2d::Zero();  ///< the middle of its bounding box
  double bottom_m = 0;                                ///< its lowest point
  double heading_rad = 0;                             ///< clockwise from the town's y axis
  double side_m = 0;  ///< of a material (town/ground/…): it is laid as a square of this side; 0: a thing with a mesh
};

/// Ground that nothing is to stand on: an object's place, or a stretch of its way.
struct KeptClear {
  Eigen::Vector2d centre_m = Eigen::Vector2d::Zero();
  double radius_m = 0;
};

/// The town and the open ground about it.
[[nodiscard]] std::vector<Placement> LayOutTown(const SceneTown& town);

/// Which of a town's placements can stay: all but what would stand on ground that is kept clear, or with its middle
/// inside a building (trees grow under no roof). A thing keeps half its diagonal away from clear ground.
/// @param sizes_m  of each placement's bounding box: along its front, across
[[nodiscard]] std::vector<bool> WhatCanStand(std::span<const Placement> town, std::span<const Eigen::Vector2d> sizes_m,
                                             std::span<const KeptClear> clear);

}  // namespace victorious

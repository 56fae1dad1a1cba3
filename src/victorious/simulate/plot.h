// Private to simulate/: a square of the town while it is furnished, and the ways to furnish one.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "victorious/base/random.h"
#include "victorious/simulate/town.h"

namespace victorious {

/// A square with its own frame: x to the right, y to its front (the street's side), from -12 m to 12 m; headings
/// clockwise from y.
class Plot {
 public:
  Plot(const Eigen::Vector2d& middle_m, int turns, Random random, double density, std::vector<Placement>& placements)
      : middle_m_(middle_m), turns_(turns), random_(random), density_(density), placements_(placements) {}

  void Tile(std::string_view tile);
  /// A square of a material of town/ground.
  void Lot(std::string_view material);
  /// `asset` is a name below town/; with `sway`, a bit aside and askew, as people leave things.
  void Put(std::string_view asset, double x_m, double y_m, double heading_deg, double sway = 0);
  /// One of these, with a chance of `share` times the town's density.
  void Maybe(double share, std::span<const std::string_view> assets, double x_m, double y_m, double heading_deg,
             double sway = 0);

  /// True with this chance, whatever the density.
  bool Chance(double share) { return random_.Uniform() < share; }
  std::string_view Pick(std::span<const std::string_view> assets) {
    return assets[random_.Below(static_cast<std::uint32_t>(assets.size()))];
  }
  Random& random() { return random_; }

 private:
  [[nodiscard]] Eigen::Vector2d InTown(double x_m, double y_m) const;
  void Place(const std::string& asset, double x_m, double y_m, double heading_rad);

  Eigen::Vector2d middle_m_;
  int turns_;
  Random random_;
  double density_;
  std::vector<Placement>& placements_;
};

/// A stretch of street along y, or where two cross.
void FurnishStreet(Plot& plot);
void FurnishJunction(Plot& plot);
/// Any other square, by lot; `at_street`: its front is a street.
void FurnishSquare(Plot& plot, bool at_street);
/// What goes with a tile that the scene chose: cars in a car park, trees in a park. Other tiles stay empty.
void FurnishTile(Plot& plot, std::string_view tile);

}  // namespace victorious

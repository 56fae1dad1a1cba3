// Private to simulate/: fills one square of the town with buildings, vehicles, trees and props.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "victorious/base/random.h"
#include "victorious/lab/simulate/town.h"

namespace victorious {

/// One square of the town with its own frame: x to the right, y to its front (the side of the street), from -12 m to
/// 12 m; headings clockwise from y.
class Parcel {
 public:
  Parcel(const Eigen::Vector2d& middle_m, int turns, Random random, double density, std::vector<Placement>& placements)
      : middle_m_(middle_m), turns_(turns), random_(random), density_(density), placements_(placements) {}

  /// Covers the square with an asset of town/tiles.
  void LayTile(std::string_view tile);
  /// Covers the middle of the square (20 m) with a material of town/ground.
  void LayMaterial(std::string_view material);
  /// Places `asset`, a name below town/. `jitter_m`: maximum random offset in x and y, m; also perturbs the heading by
  /// up to 0.12 rad per metre. Assets of trees/ get a random heading.
  void Put(std::string_view asset, double x_m, double y_m, double heading_deg, double jitter_m = 0);
  /// Places a random one of `assets` with probability `probability` * density.
  void PutWithProbability(double probability, std::span<const std::string_view> assets, double x_m, double y_m,
                          double heading_deg, double jitter_m = 0);

  /// A Bernoulli draw with this probability, independent of the density.
  bool DrawBool(double probability) { return random_.Uniform() < probability; }
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

/// A street along y; a junction.
void FurnishStreet(Parcel& parcel);
void FurnishJunction(Parcel& parcel);
/// Any other square, chosen at random; `at_street`: its front faces a street.
void FurnishSquare(Parcel& parcel, bool at_street);
/// A tile that the scene specifies, with its contents: cars in a car park, trees in a park. Other tiles stay empty.
void FurnishTile(Parcel& parcel, std::string_view tile);

}  // namespace victorious

// How high mean sea level lies above the WGS 84 ellipsoid: a grid of a geoid model in the .gtx format of NOAA and PROJ.
//
//   height above the ellipsoid = height above the sea + Geoid::HeightAt
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "victorious/base/error.h"

namespace victorious {

class Geoid {
 public:
  /// Errors: those of reading; kDataLoss for a file that is no such grid, or is cut off.
  static Expected<Geoid> Read(const std::filesystem::path& path);

  /// @param bytes  a .gtx file
  static Expected<Geoid> Parse(std::string_view bytes);

  /// Between the grid's points linearly along both axes, metres; nothing beyond the grid.
  [[nodiscard]] std::optional<double> HeightAt(double latitude_rad, double longitude_rad) const;

 private:
  double south_deg_ = 0;
  double west_deg_ = 0;
  double latitude_step_deg_ = 0;
  double longitude_step_deg_ = 0;
  int rows_ = 0;
  int columns_ = 0;
  std::vector<float> heights_m_;  ///< by rows, from the south
};

/// Where PROJ's grid of EGM96 lies on this machine ($PROJ_DATA, $PROJ_LIB, /usr/share/proj); nothing if it does not.
[[nodiscard]] std::optional<std::filesystem::path> FindEgm96Grid();

}  // namespace victorious

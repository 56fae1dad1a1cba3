// telemetry/: the geoid undulation (height of mean sea level above the WGS 84 ellipsoid) from a grid of a geoid model
// in the .gtx format of NOAA and PROJ.
//
//   height above the ellipsoid = height above mean sea level + Geoid::UndulationAt
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "victorious/base/error.h"

namespace victorious {

class Geoid {
 public:
  /// Errors: those of ReadFile; kDataLoss for a file that is not a .gtx grid or is truncated.
  [[nodiscard]] static Expected<Geoid> Read(const std::filesystem::path& path);

  /// @param bytes  content of a .gtx file
  /// Errors: kDataLoss as for Read.
  [[nodiscard]] static Expected<Geoid> Parse(std::string_view bytes);

  /// @return the undulation, m, by bilinear interpolation; std::nullopt outside the grid or at "no data"
  [[nodiscard]] std::optional<double> UndulationAt(double latitude_rad, double longitude_rad) const;

 private:
  double south_deg_ = 0;
  double west_deg_ = 0;
  double latitude_step_deg_ = 0;
  double longitude_step_deg_ = 0;
  int rows_ = 0;
  int columns_ = 0;
  std::vector<float> heights_m_;  ///< row by row, from the south
};

/// The path of PROJ's EGM96 grid (egm96_15.gtx) in $PROJ_DATA, $PROJ_LIB or /usr/share/proj; std::nullopt if absent.
[[nodiscard]] std::optional<std::filesystem::path> FindEgm96Grid();

}  // namespace victorious

// Synthetic lines of sight from a flight past one object, with truth: independent and common telemetry errors,
// outliers.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "victorious/types/line_of_sight.h"

namespace victorious::testing {

struct SyntheticLinesOptions {
  std::uint64_t seed = 1;
  int count = 100;
  double duration_s = 60;
  double distance_m = 300;                ///< horizontal, from the object's place at the last line
  double height_m = 200;                  ///< above the object
  double arc_deg = 120;                   ///< arc of the circle flown; 0: the camera does not move
  Eigen::Vector3d velocity_enu{0, 0, 0};  ///< of the object, m/s
  double outlier_fraction = 0;            ///< fraction of outliers: up to 15 degrees off in each angle
  double noise_position_m = 0;            ///< sigma, independent for each line and axis
  double noise_deg = 0;                   ///< sigma, independent for each line, azimuth and elevation
  double bias_position_m = 0;             ///< sigma of the common error of the flight, per axis
  double bias_deg = 0;                    ///< sigma of the common error of the flight, azimuth and elevation
  double range_fraction = 0;              ///< sigma of the given ranges, as a fraction of the distance; 0: no ranges
};

struct SyntheticLines {
  std::vector<LineOfSight> lines;  ///< in order of time, from 0 s
  std::vector<bool> wrong;
  GeodeticPoint object;  ///< at the last line's time
};

/// The same options give the same lines.
SyntheticLines SimulateLinesOfSight(const SyntheticLinesOptions& options);

}  // namespace victorious::testing

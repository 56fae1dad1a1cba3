// Lines of sight from a flight past one object, with the truth: own and common errors as of telemetry, wrong lines.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "victorious/types/line_of_sight.h"

namespace victorious::testing {

struct DrawnLinesOptions {
  std::uint64_t seed = 1;
  int count = 100;
  double duration_s = 60;
  double distance_m = 300;                ///< from the object's place at the last line, along the ground
  double height_m = 200;                  ///< above the object
  double arc_deg = 120;                   ///< of the circle flown; 0 stands still
  Eigen::Vector3d velocity_enu{0, 0, 0};  ///< of the object, m/s
  double wrong_share = 0;                 ///< of lines that point elsewhere: up to 15 degrees off in each angle
  double noise_position_m = 0;            ///< of each line, each axis
  double noise_deg = 0;                   ///< of each line, azimuth and elevation
  double bias_position_m = 0;             ///< sigma of one draw a flight, each axis
  double bias_deg = 0;                    ///< sigma of one draw a flight, azimuth and elevation
  double range_share = 0;                 ///< sigma of told ranges over the distance; 0: none are told
};

struct DrawnLines {
  std::vector<LineOfSight> lines;  ///< in order of time, from 0 s
  std::vector<bool> wrong;
  GeodeticPoint object;  ///< at the last line's time
};

/// The same options give the same lines.
DrawnLines DrawLinesOfSight(const DrawnLinesOptions& options);

}  // namespace victorious::testing

// Points whose place is surveyed, with the lines of sight along which pictures show them: what estimators of places are
// held against where nothing is simulated (real/geo_gcp in the folder of outside data).
//
// A survey's grid is taken for east, north and up in one tangent plane. Over the few hundred metres of a site that errs
// by a few centimetres: the grid's own scale.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "victorious/base/error.h"
#include "victorious/evaluate/experiments/experiment.h"
#include "victorious/geolocate/locate_options.h"
#include "victorious/geolocate/object_pose.h"
#include "victorious/geometry/attitude.h"
#include "victorious/geometry/camera.h"
#include "victorious/geometry/lens.h"
#include "victorious/types/line_of_sight.h"

namespace victorious {

/// A camera where it was when it took a picture.
struct StandingCamera {
  PinholeCamera pinhole;
  LensDistortion lens = {};
  GeodeticPoint place;
  Attitude attitude;  ///< at `place`
};

/// Along which line a pixel was seen, lens undone.
[[nodiscard]] LineOfSight LineThrough(const Eigen::Vector2d& pixel, const StandingCamera& camera, double time_s);

/// One surveyed point.
struct PlaceTrial {
  std::string point;
  GeodeticPoint truth;
  LocateOptions told;              ///< the errors of the cameras and lines
  std::vector<LineOfSight> lines;  ///< one a picture, in order of time
  double others_m = 0;             ///< the mean height of the site's other points: flat ground, as one would tell it
  double others_sigma_m = 0;       ///< how far a point is from that, by the others' scatter
};

/// Trials of one site whose cameras are known in one way.
struct PlaceSeries {
  std::string name;
  std::vector<PlaceTrial> trials;
};

/// A hovering drone above a beach, 240 to 440 m from four ground control points: with the poses that were solved for
/// each picture, and with the telemetry of the first as it was recorded.
/// Errors: kNotFound, and those of reading.
Expected<std::vector<PlaceSeries>> LoadNarrabeen(const ExperimentSettings& settings);

/// A fixed camera over a river, some 15 m from six crosses. Each cross is placed with the pose that the other five
/// give.
Expected<PlaceSeries> LoadGeul(const ExperimentSettings& settings);

}  // namespace victorious

// Surveyed ground control points with the lines of sight of real cameras to them (real/geo_gcp in the folder of
// external data). They test the estimators of geolocate/ without simulation.
//
// The survey grid is treated as east, north and up of one tangent plane. Over the few hundred metres of a site, the
// grid scale causes an error of a few centimetres.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "experiments/experiment.h"
#include "victorious/base/error.h"
#include "victorious/geometry/attitude.h"
#include "victorious/geometry/camera.h"
#include "victorious/geometry/lens.h"
#include "victorious/place/geolocate/locate_options.h"
#include "victorious/place/geolocate/object_pose.h"
#include "victorious/types/line_of_sight.h"

namespace victorious {

/// A georeferenced camera: intrinsics, lens distortion, place and attitude at the time of an image.
struct GeoreferencedCamera {
  PinholeCamera pinhole;
  LensDistortion lens = {};
  GeodeticPoint place;
  Attitude attitude;  ///< at `place`
};

/// Returns the line of sight through a pixel, with the lens distortion removed. Its standard deviation is one pixel.
[[nodiscard]] LineOfSight LineOfSightThrough(const Eigen::Vector2d& pixel, const GeoreferencedCamera& camera,
                                             double time_s);

/// One surveyed point.
struct PlaceTrial {
  std::string point;
  GeodeticPoint truth;
  LocateOptions locate_options;    ///< the given error model of the cameras and lines
  std::vector<LineOfSight> lines;  ///< one per image, in order of time
  double others_height_m = 0;      ///< mean height of the site's other points, used as the height of flat ground
  double others_sigma_m = 0;       ///< standard deviation of a point from that height, from the scatter of the others
};

/// The trials of one site with one source of camera poses.
struct PlaceSeries {
  std::string name;
  std::vector<PlaceTrial> trials;
};

/// Loads the Narrabeen data: a hovering drone above a beach, 240 to 440 m from four ground control points. Returns
/// three series: with the pose solved for each image; with the recorded telemetry of the first image; and the same with
/// a stated standard deviation of 3 degrees.
/// Errors: kNotFound, and those of reading.
[[nodiscard]] Expected<std::vector<PlaceSeries>> LoadNarrabeen(const ExperimentSettings& settings);

/// Loads the Geul data: a fixed camera over a river, about 15 m from six crosses. The camera pose of each trial is
/// fitted to the other five crosses (leave-one-out).
/// Errors: kNotFound, kDataLoss if no pose fits, and those of reading.
[[nodiscard]] Expected<PlaceSeries> LoadGeul(const ExperimentSettings& settings);

}  // namespace victorious

// The parameters of geolocation (locate.h).
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "victorious/base/options.h"
#include "victorious/geometry/ground.h"

namespace victorious {

/// Standard deviations of the errors that are common to all lines of sight of a flight. They do not average out.
struct CommonErrorOptions {
  double position_m = 2;
  double height_m = 2;
  double heading_deg = 0.5;
  double boresight_side_deg = 0.1;
  double boresight_rise_deg = 0.5;
  double range_fraction = 0.02;

  void ListFields(FieldList& fields) {
    fields.Add("position_m", position_m,
               {.min = 0,
                .max = 1e5,
                .unit = "m",
                .reason = "sigma of the common error of the camera positions, east and north each"});
    fields.Add("height_m", height_m,
               {.min = 0,
                .max = 1e5,
                .unit = "m",
                .reason = "sigma of the common error in height, for example of the take-off height"});
    fields.Add("heading_deg", heading_deg,
               {.min = 0, .max = 180, .unit = "deg", .reason = "sigma of the common error in heading"});
    fields.Add(
        "boresight_side_deg", boresight_side_deg,
        {.min = 0,
         .max = 90,
         .unit = "deg",
         .reason = "sigma of the camera's boresight misalignment to the side, in addition to the heading error"});
    fields.Add("boresight_rise_deg", boresight_rise_deg,
               {.min = 0,
                .max = 90,
                .unit = "deg",
                .reason = "sigma of the common error in elevation (boresight misalignment upwards)"});
    fields.Add("range_fraction", range_fraction,
               {.min = 0,
                .max = 1,
                .unit = "",
                .reason = "sigma of the common relative error of the ranges: object size, focal length"});
  }
};

/// Standard deviations of the independent errors of one line. The `sigma_*` columns of the lines take precedence.
struct LineErrorOptions {
  double position_m = 2;
  double angle_deg = 0.5;
  double range_fraction = 0.15;

  void ListFields(FieldList& fields) {
    fields.Add("position_m", position_m,
               {.min = 0,
                .max = 1e5,
                .unit = "m",
                .reason = "sigma of the independent error of a camera position, along each axis"});
    fields.Add("angle_deg", angle_deg,
               {.min = 1e-6, .max = 90, .unit = "deg", .reason = "sigma of each angle, for lines without sigma_deg"});
    fields.Add("range_fraction", range_fraction,
               {.min = 1e-6,
                .max = 10,
                .unit = "",
                .reason = "sigma of the range divided by the range, for lines without sigma_range_m"});
  }
};

struct LocateOptions {
  std::string motion = "static";
  std::string method = "ml";
  double min_travel_m = 1;
  double identity_radius_m = 2;
  double distance_prior_allowance = 1.5;
  double gate_sigma = 3;
  double robust_sigma = 2.5;
  double max_error_fraction = 0.5;
  double ground_sigma_m = 2;
  int max_hypotheses = 500;
  double confidence = 0.9999;
  std::uint64_t seed = 1;
  LineErrorOptions line;
  CommonErrorOptions common;
  std::shared_ptr<const Ground> ground;  ///< on which objects stand, if given; set by the caller, not a parameter

  void ListFields(FieldList& fields) {
    fields.Add("motion", motion,
               {.choices = {"static", "velocity", "auto"},
                .reason = "motion model of the object: static, constant velocity, or auto: selected from the lines"});
    fields.Add("min_travel_m", min_travel_m,
               {.min = 0,
                .max = 1e5,
                .unit = "m",
                .reason = "auto selects static if the object moves by less than this over the duration of the lines"});
    fields.Add(
        "method", method,
        {.choices = {"ml", "ransac", "prior", "least-squares", "ground"},
         .reason =
             "the estimator; ml refines ransac's inliers and is the only one that weighs every error by its model"});
    fields.Add("identity_radius_m", identity_radius_m,
               {.min = 0,
                .max = 1e4,
                .unit = "m",
                .reason = "IDENTITY_RADIUS: maximum distance of a point of the object from its line, without errors"});
    fields.Add("distance_prior_allowance", distance_prior_allowance,
               {.min = 1,
                .max = 1e3,
                .unit = "",
                .reason = "DISTANCE_PRIOR_ALLOWANCE: maximum factor between the distance and the given range"});
    fields.Add("gate_sigma", gate_sigma,
               {.min = 0.5,
                .max = 20,
                .unit = "",
                .reason = "a line with a larger residual, in sigmas, is an outlier: 3 keeps 98.9 % of inliers with two "
                          "normal angles"});
    fields.Add("robust_sigma", robust_sigma,
               {.min = 0.5,
                .max = 20,
                .unit = "",
                .reason = "residual, in sigmas, where Huber's loss of the refinement becomes linear"});
    fields.Add("max_error_fraction", max_error_fraction,
               {.min = 0.01,
                .max = 10,
                .unit = "",
                .reason = "maximum sigma of a place along any axis, as a fraction of its distance; a less certain "
                          "place is not reported"});
    fields.Add("ground_sigma_m", ground_sigma_m,
               {.min = 1e-3, .max = 1e5, .unit = "m", .reason = "sigma of the ground height, if a ground is given"});
    fields.Add("max_hypotheses", max_hypotheses, {.min = 1, .max = 1e6, .reason = "maximum number of RANSAC samples"});
    fields.Add("confidence", confidence,
               {.min = 0.5,
                .max = 0.9999999,
                .reason = "RANSAC stops when an outlier-free sample has been drawn with this probability"});
    fields.Add("seed", seed, {.reason = "random seed of RANSAC"});
    fields.AddGroup("line", line);
    fields.AddGroup("common", common);
  }
};

}  // namespace victorious

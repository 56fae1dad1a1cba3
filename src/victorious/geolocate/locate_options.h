// The parameters of geolocation.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "victorious/base/options.h"
#include "victorious/geometry/ground.h"

namespace victorious {

/// Standard deviations of what errs alike in all lines of a flight. It does not average out.
struct CommonErrorOptions {
  double position_m = 2;
  double height_m = 2;
  double heading_deg = 0.5;
  double boresight_side_deg = 0.1;
  double boresight_rise_deg = 0.5;
  double range_share = 0.02;

  void ListFields(FieldList& fields) {
    fields.Add(
        "position_m", position_m,
        {.min = 0, .max = 1e5, .unit = "m", .reason = "sigma of the cameras' common error, east and north each"});
    fields.Add("height_m", height_m,
               {.min = 0, .max = 1e5, .unit = "m", .reason = "sigma of the common error in height: of take-off, say"});
    fields.Add("heading_deg", heading_deg,
               {.min = 0, .max = 180, .unit = "deg", .reason = "sigma of the common error about the vertical"});
    fields.Add("boresight_side_deg", boresight_side_deg,
               {.min = 0,
                .max = 90,
                .unit = "deg",
                .reason = "sigma of the camera's misalignment to the side, beyond what heading holds already"});
    fields.Add("boresight_rise_deg", boresight_rise_deg,
               {.min = 0, .max = 90, .unit = "deg", .reason = "sigma of the common error in elevation"});
    fields.Add("range_share", range_share,
               {.min = 0, .max = 1, .unit = "", .reason = "sigma of the ranges' common factor: object size, lens"});
  }
};

/// What one line's own error is; `sigma_*` columns of the lines go before.
struct LineErrorOptions {
  double position_m = 2;
  double angle_deg = 0.5;
  double range_share = 0.15;

  void ListFields(FieldList& fields) {
    fields.Add("position_m", position_m,
               {.min = 0, .max = 1e5, .unit = "m", .reason = "sigma of a camera's own error, along each axis"});
    fields.Add("angle_deg", angle_deg,
               {.min = 1e-6, .max = 90, .unit = "deg", .reason = "sigma of each angle, where a line tells none"});
    fields.Add("range_share", range_share,
               {.min = 1e-6, .max = 10, .unit = "", .reason = "sigma over range, where a line tells none"});
  }
};

struct LocateOptions {
  std::string motion = "static";
  std::string method = "ml";
  double least_travel_m = 1;
  double identity_radius_m = 2;
  double distance_prior_allowance = 1.5;
  double gate_sigma = 3;
  double robust_sigma = 2.5;
  double largest_error_share = 0.5;
  double ground_sigma_m = 2;
  int max_hypotheses = 500;
  double confidence = 0.9999;
  std::uint64_t seed = 1;
  LineErrorOptions line;
  CommonErrorOptions common;
  std::shared_ptr<const Ground> ground;  ///< that objects are on, if any: told with the lines, no parameter

  void ListFields(FieldList& fields) {
    fields.Add("motion", motion,
               {.choices = {"static", "velocity", "auto"},
                .reason = "how the object moves: not at all, or steadily; auto: as the lines say"});
    fields.Add("least_travel_m", least_travel_m,
               {.min = 0,
                .max = 1e5,
                .unit = "m",
                .reason = "auto takes less than this, over the time of the lines, for standing still"});
    fields.Add("method", method,
               {.choices = {"ml", "ransac", "prior", "least-squares", "ground"},
                .reason = "the estimator; ml refines what ransac keeps, and alone weighs errors as they are"});
    fields.Add("identity_radius_m", identity_radius_m,
               {.min = 0,
                .max = 1e4,
                .unit = "m",
                .reason = "IDENTITY_RADIUS: how far from its line a point of one object may lie, errors apart"});
    fields.Add("distance_prior_allowance", distance_prior_allowance,
               {.min = 1,
                .max = 1e3,
                .unit = "",
                .reason = "DISTANCE_PRIOR_ALLOWANCE: the largest factor between the distance and the range told"});
    fields.Add(
        "gate_sigma", gate_sigma,
        {.min = 0.5,
         .max = 20,
         .unit = "",
         .reason = "a line further off than this many sigmas is an outlier: 3 keep 98.9 % of two normal angles"});
    fields.Add("robust_sigma", robust_sigma,
               {.min = 0.5, .max = 20, .unit = "", .reason = "where Huber's loss of the refinement turns linear"});
    fields.Add("largest_error_share", largest_error_share,
               {.min = 0.01,
                .max = 10,
                .unit = "",
                .reason = "a place whose largest sigma is a greater share of the distance is none: it is withheld"});
    fields.Add("ground_sigma_m", ground_sigma_m,
               {.min = 1e-3, .max = 1e5, .unit = "m", .reason = "sigma of the ground's height, where one is told"});
    fields.Add("max_hypotheses", max_hypotheses, {.min = 1, .max = 1e6, .reason = "samples that RANSAC draws at most"});
    fields.Add("confidence", confidence,
               {.min = 0.5, .max = 0.9999999, .reason = "RANSAC ends when a clean sample was drawn with this chance"});
    fields.Add("seed", seed, {.reason = "of RANSAC's draws"});
    fields.AddGroup("line", line);
    fields.AddGroup("common", common);
  }
};

}  // namespace victorious

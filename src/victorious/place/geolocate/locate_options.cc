#include "victorious/place/geolocate/locate_options.h"

namespace victorious {
namespace {

// The fields that `locate` and the commands on videos have in common.

void ListAngle(LineErrorOptions& line, FieldList& fields) {
  fields.Add("angle_deg", line.angle_deg,
             {.min = 1e-6, .max = 90, .unit = "deg", .reason = "sigma of each angle, for lines without sigma_deg"});
}

void ListFlightErrors(CommonErrorOptions& common, FieldList& fields) {
  fields.Add("position_m", common.position_m,
             {.min = 0,
              .max = 1e5,
              .unit = "m",
              .reason = "sigma of the common error of the camera positions, east and north each"});
  fields.Add("height_m", common.height_m,
             {.min = 0,
              .max = 1e5,
              .unit = "m",
              .reason = "sigma of the common error in height, for example of the take-off height"});
  fields.Add("heading_deg", common.heading_deg,
             {.min = 0, .max = 180, .unit = "deg", .reason = "sigma of the common error in heading"});
}

void ListGates(LocateOptions& locate, FieldList& fields) {
  fields.Add("identity_radius_m", locate.identity_radius_m,
             {.min = 0,
              .max = 1e4,
              .unit = "m",
              .reason = "IDENTITY_RADIUS: maximum distance of a point of the object from its line, without errors"});
  fields.Add("distance_prior_allowance", locate.distance_prior_allowance,
             {.min = 1,
              .max = 1e3,
              .unit = "",
              .reason = "DISTANCE_PRIOR_ALLOWANCE: maximum factor between the distance and the given range"});
  fields.Add("gate_sigma", locate.gate_sigma,
             {.min = 0.5,
              .max = 20,
              .unit = "",
              .reason = "a line with a larger residual, in sigmas, is an outlier: 3 keeps 98.9 % of inliers with two "
                        "normal angles"});
  fields.Add("ground_sigma_m", locate.ground_sigma_m,
             {.min = 1e-3, .max = 1e5, .unit = "m", .reason = "sigma of the ground height, if a ground is given"});
}

// Lists the fields that a function lists.
template <typename List>
struct Group {
  List list;

  void ListFields(FieldList& fields) const { list(fields); }
};

}  // namespace

void CommonErrorOptions::ListFields(FieldList& fields) {
  ListFlightErrors(*this, fields);
  fields.Add("range_fraction", range_fraction,
             {.min = 0,
              .max = 1,
              .unit = "",
              .reason = "sigma of the common relative error of the ranges: object size, focal length"});
}

void LineErrorOptions::ListFields(FieldList& fields) {
  fields.Add("position_m", position_m,
             {.min = 0,
              .max = 1e5,
              .unit = "m",
              .reason = "sigma of the independent error of a camera position, along each axis"});
  ListAngle(*this, fields);
  fields.Add("range_fraction", range_fraction,
             {.min = 1e-6,
              .max = 10,
              .unit = "",
              .reason = "sigma of the range divided by the range, for lines without sigma_range_m"});
}

void LocateOptions::ListFields(FieldList& fields) {
  fields.Add("motion", motion, kMotionModelTexts,
             {.reason = "motion model of the object: static, constant velocity, or auto: selected from the lines"});
  fields.Add(
      "method", method, kLocateMethodTexts,
      {.reason =
           "the estimator; ml refines ransac's inliers and is the only one that weighs every error by its model"});
  ListGates(*this, fields);
  fields.Add("robust_sigma", robust_sigma,
             {.min = 0.5,
              .max = 20,
              .unit = "",
              .reason = "residual, in sigmas, where Huber's loss of the refinement becomes linear"});
  fields.Add("max_hypotheses", max_hypotheses, {.min = 1, .max = 1e6, .reason = "maximum number of RANSAC samples"});
  fields.Add("seed", seed, {.reason = "random seed of RANSAC"});
  fields.AddGroup("line", line);
  fields.AddGroup("common", common);
}

void VideoLocateFields::ListFields(FieldList& fields) const {
  ListGates(locate, fields);
  Group line{[this](FieldList& list) { ListAngle(locate.line, list); }};
  fields.AddGroup("line", line);
  Group common{[this](FieldList& list) { ListFlightErrors(locate.common, list); }};
  fields.AddGroup("common", common);
}

}  // namespace victorious

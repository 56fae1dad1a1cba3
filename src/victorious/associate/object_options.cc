#include "victorious/associate/object_options.h"

#include <cmath>

namespace victorious {

void ObjectOptions::ListFields(FieldList& fields) {
  fields.Add(
      "merge_gate_sigma", merge_gate_sigma,
      {.min = 0,
       .max = 100,
       .unit = "",
       .reason =
           "two tracklets are merged if the Mahalanobis distance of their places is at most this; 0 merges none"});
  fields.Add("merge_slack_m", merge_slack_m,
             {.min = 0,
              .max = 1000,
              .unit = "m",
              .reason = "standard deviation added to each place when two are compared: the apparent centres of two "
                        "sides of an object differ"});
  fields.Add(
      "max_merge_distance_m", max_merge_distance_m,
      {.min = 0,
       .max = 1e5,
       .unit = "m",
       .reason =
           "places further apart are never merged, however uncertain: objects of one model may stand side by side"});
  fields.Add("flight_error_fraction", flight_error_fraction,
             {.min = 0,
              .max = 1,
              .unit = "",
              .reason = "fraction of a flight's common errors that does not cancel between two places of that flight"});
  fields.Add(
      "min_inlier_fraction", min_inlier_fraction,
      {.min = 0,
       .max = 1,
       .unit = "",
       .reason =
           "minimum fraction of lines of sight that must be inliers of the place; below it the object is rejected"});
  fields.Add("motion_window_s", motion_window_s,
             {.min = 0.1,
              .max = 1e6,
              .unit = "s",
              .reason = "a moving object is placed by the observations of its last interval of this length: its "
                        "velocity is constant only for a while"});
  fields.Add("max_size_ratio", max_size_ratio,
             {.min = 1,
              .max = 1e6,
              .unit = "",
              .reason = "an object whose apparent size is too large or too small for its distance by more than this "
                        "factor is rejected"});
  fields.Add("max_height_deviation_m", max_height_deviation_m,
             {.min = 0,
              .max = 1e6,
              .unit = "m",
              .reason = "an object whose height follows from its size only, and differs from the median height of the "
                        "others by this or more, is rejected"});
  fields.Add("min_separation_m", min_separation_m,
             {.min = 0,
              .max = 1000,
              .unit = "m",
              .reason = "of two objects whose centres are nearer than this, the one with fewer frames is rejected"});
  fields.Add("occlusion_iou", occlusion_iou,
             {.min = 0,
              .max = 1,
              .reason = "of two objects of different CAD models, the one with fewer frames is rejected if their boxes "
                        "overlap by this (intersection over union) in half of its frames"});
  fields.Add("false_alarm_rate", false_alarm_rate,
             {.min = 0,
              .max = 1,
              .unit = "",
              .reason = "expected number of false detections with even odds per frame and model; an object is rejected "
                        "as insignificant if more than 0.1 false detections as strong as it are expected over the "
                        "whole search; 0 rejects none"});
  fields.Add("centre_height_m", centre_height_m,
             {.min = -100,
              .max = 1e4,
              .unit = "m",
              .reason = "height of objects' centres above the given ground: half a vehicle's height"});
  fields.Add("centre_height_sigma_m", centre_height_sigma_m,
             {.min = 0,
              .max = 1e4,
              .unit = "m",
              .reason = "standard deviation of that height, in addition to that of the ground"});
  fields.AddGroup("locate", locate);
}

LocateOptions ObjectOptions::LocateOnGround() const {
  LocateOptions of_middle = locate;
  if (ground) {
    of_middle.ground = std::make_shared<const RaisedGround>(ground, centre_height_m);
    of_middle.ground_sigma_m = std::hypot(locate.ground_sigma_m, centre_height_sigma_m);
  }
  return of_middle;
}

LocateOptions ObjectOptions::SingleVideoDefaults() {
  LocateOptions options;
  options.motion = "auto";
  options.line.position_m = 0.1;
  return options;
}

}  // namespace victorious

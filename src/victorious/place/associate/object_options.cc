#include "victorious/place/associate/object_options.h"

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
  fields.Add(
      "max_merge_distance_m", max_merge_distance_m,
      {.min = 0,
       .max = 1e5,
       .unit = "m",
       .reason =
           "places further apart are never merged, however uncertain: objects of one model may stand side by side"});
  fields.Add(
      "min_inlier_fraction", min_inlier_fraction,
      {.min = 0,
       .max = 1,
       .unit = "",
       .reason =
           "minimum fraction of lines of sight that must be inliers of the place; below it the object is rejected"});
  fields.Add("max_size_ratio", max_size_ratio,
             {.min = 1,
              .max = 1e6,
              .unit = "",
              .reason = "the place of an object whose apparent size is too large or too small for its distance by more "
                        "than this factor is rejected, unless the object drives at the distance of its size"});
  fields.Add("false_alarm_rate", false_alarm_rate,
             {.min = 0,
              .max = 1,
              .unit = "",
              .reason = "expected number of false detections with even odds per frame and model; an object is rejected "
                        "as insignificant if more than 0.1 false detections as strong as it are expected an hour of "
                        "video; 0 rejects none"});
  fields.Add(
      "telemetry_errors", telemetry_errors, kErrorSourceTexts,
      {.reason = "where the sizes of telemetry's errors come from: supposed: objects.locate; rows: the errors of "
                 "its rows, as the lines of sight of the flight show them; receiver: those common to the flight "
                 "are of the same class as those of its rows, too, if it is a table of camera states"});
  VideoLocateFields fields_of_locate{locate};
  fields.AddGroup("locate", fields_of_locate);
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
  options.motion = MotionModel::kAuto;
  options.line.position_m = 0.1;
  return options;
}

}  // namespace victorious

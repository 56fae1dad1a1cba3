#include "victorious/track/box_track_options.h"

namespace victorious {

void BoxTrackOptions::ListFields(FieldList& fields) {
  fields.Add(
      "window_factor", window_factor,
      {.min = 2,
       .max = 20,
       .reason = "side of the search window relative to the object's size (square root of its area): half of it, minus "
                 "half the object, is the largest motion between frames relative to the camera's motion"});
  fields.Add(
      "temporal_weight", temporal_weight,
      {.min = 0,
       .max = 1e4,
       .reason = "weight of the temporal regularisation of the correlation filter, in units of the window's energy: "
                 "larger values adapt more slowly"});
  fields.Add("velocity_learning_rate", velocity_learning_rate,
             {.min = 0,
              .max = 1,
              .reason = "learning rate of the object's own velocity; velocity and camera motion predict the position"});
  fields.Add("scale_learning_rate", scale_learning_rate,
             {.min = 0, .max = 1, .reason = "learning rate of the scale filter"});
  fields.Add(
      "template_confidence", template_confidence,
      {.min = 0,
       .max = 1,
       .reason = "minimum confidence to store a template of a frame. Confidence is 1 if the response's sharpness and "
                 "the NCC with the templates are at their running means for this object"});
  fields.Add("update_confidence", update_confidence,
             {.min = 0,
              .max = 1,
              .reason = "minimum confidence to update the filters: below it, an occluder would be learnt too"});
  fields.Add("lost_confidence", lost_confidence,
             {.min = 0, .max = 1, .reason = "confidence below which the object is lost"});
  fields.Add(
      "redetect_confidence", redetect_confidence,
      {.min = 0,
       .max = 1,
       .reason = "minimum confidence to re-detect a lost object: above lost_confidence, since the whole frame is "
                 "searched"});
  fields.Add("min_in_view", min_in_view,
             {.min = 0,
              .max = 1,
              .reason = "minimum fraction of the box inside the frame; below it the object has left the frame"});
}

}  // namespace victorious

#include "victorious/track/box_track_options.h"

namespace victorious {

void BoxTrackOptions::ListFields(FieldList& fields) {
  fields.Add(
      "window_factor", window_factor,
      {.min = 2,
       .max = 20,
       .reason = "side of the searched window over the object's (square root of its area): half of it, less half "
                 "the object, is how far the object may go between two frames beside the camera's motion"});
  fields.Add(
      "stay", stay,
      {.min = 0,
       .max = 1e4,
       .reason = "how strongly the filter is held near that of the frame before, in units of the window's energy: "
                 "more forgets more slowly"});
  fields.Add("velocity_rate", velocity_rate,
             {.min = 0,
              .max = 1,
              .reason = "how much of what was known of the object's own motion each frame replaces: it is sought where "
                        "this motion and the camera's have brought it"});
  fields.Add("scale_rate", scale_rate,
             {.min = 0, .max = 1, .reason = "how much of what was known of the object's size each frame replaces"});
  fields.Add(
      "sure_trust", sure_trust,
      {.min = 0,
       .max = 1,
       .reason = "trust from which a frame's look is remembered for good. Trust is 1 where the filter's answer is as "
                 "sharp and the look as like as is usual for this object"});
  fields.Add(
      "learn_trust", learn_trust,
      {.min = 0,
       .max = 1,
       .reason = "trust from which filter and size are learnt: below, what covers the object would be learnt too"});
  fields.Add("lost_trust", lost_trust, {.min = 0, .max = 1, .reason = "trust below which the object is not seen"});
  fields.Add("return_trust", return_trust,
             {.min = 0,
              .max = 1,
              .reason = "trust from which something is taken for the object again after it was lost: more than what is "
                        "enough to go on, since it may be anywhere"});
  fields.Add(
      "least_in_view", least_in_view,
      {.min = 0, .max = 1, .reason = "share of the box that must lie in the frame, else the object has left it"});
}

}  // namespace victorious

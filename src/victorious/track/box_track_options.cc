#include "victorious/track/box_track_options.h"

namespace victorious {

void BoxTrackOptions::ListFields(FieldList& fields) {
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

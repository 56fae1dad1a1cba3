#include "victorious/track/track_options.h"

namespace victorious {

void TrackOptions::ListFields(FieldList& fields) {
  fields.Add(
      "dilation_factor", dilation_factor,
      {.min = 1,
       .max = 10,
       .reason = "side of the search region relative to the outline's bounding box (thesis, section 4.4): a margin "
                 "for keypoints on the object's edge and for tracking errors"});
  fields.Add(
      "unconfirmed_frames", unconfirmed_frames,
      {.min = 1,
       .max = 1'000'000,
       .unit = "frames",
       .reason = "a track becomes inactive after more than this many frames without a confirmation by the recogniser "
                 "(the thesis's M): its template is then out of date"});
  fields.Add(
      "missed_frames", missed_frames,
      {.min = 0,
       .max = 10'000,
       .unit = "frames",
       .reason = "a track is kept, without a box, over at most this many consecutive frames in which it is not seen: "
                 "flicker and short occlusions"});
}

}  // namespace victorious

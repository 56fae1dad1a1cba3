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
  fields.Add("predict_motion", predict_motion,
             {.reason = "start the search for the points where the object's velocity predicts them, also after a loss "
                        "(thesis, section 4.4), or for a new track where the global image motion predicts them; false: "
                        "at their last positions"});
  fields.Add("window_px", window_px,
             {.min = 5, .max = 101, .unit = "px", .reason = "side of the Lucas-Kanade window on each pyramid level"});
  fields.Add(
      "pyramid_levels", pyramid_levels,
      {.min = 1,
       .max = 8,
       .reason = "each level doubles the motion that can be tracked: 4 levels allow about 50 px per frame relative "
                 "to the prediction"});
  fields.Add("forward_backward_px", forward_backward_px,
             {.min = 0.05, .max = 100, .unit = "px", .reason = "maximum forward-backward error of a tracked point"});
  fields.Add(
      "min_ncc", min_ncc,
      {.min = -1,
       .max = 1,
       .reason = "minimum NCC of a point's patch with its patch in the template; -1 disables the check: the track "
                 "then follows any motion and drifts"});
  fields.Add("patch_px", patch_px, {.min = 5, .max = 101, .unit = "px", .reason = "side of a point's patch"});
  fields.Add("noise_px", noise_px,
             {.min = 0.1, .max = 100, .unit = "px", .reason = "standard deviation of a tracked point's position"});
  fields.Add(
      "shape_fraction", shape_fraction,
      {.min = 0,
       .max = 1,
       .reason = "model error of the similarity for an object that rotates out of the image plane, as a fraction of "
                 "its size (square root of its outline's area)"});
  fields.Add("min_points", min_points,
             {.min = 3, .max = 10'000, .reason = "minimum number of inlier points for the object to be seen"});
  fields.Add(
      "min_support", min_support,
      {.min = 0, .max = 1, .reason = "minimum fraction of inliers among the template's points inside the frame"});
  fields.Add(
      "min_in_view", min_in_view,
      {.min = 0,
       .max = 1,
       .reason = "minimum fraction of the outline's area inside the frame; below it the object has left the frame"});
}

}  // namespace victorious

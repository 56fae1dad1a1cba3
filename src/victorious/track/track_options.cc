#include "victorious/track/track_options.h"

namespace victorious {

void TrackOptions::ListFields(FieldList& fields) {
  fields.Add(
      "dilation_factor", dilation_factor,
      {.min = 1,
       .max = 10,
       .reason = "the searched region's side over that of the box around the outline (thesis, section 4.4): room "
                 "for keypoints on the object's edge, and for a step that went a little wrong"});
  fields.Add(
      "unconfirmed_frames", unconfirmed_frames,
      {.min = 1,
       .max = 1'000'000,
       .unit = "frames",
       .reason = "a track that no recogniser has confirmed for more than so many becomes inactive (the thesis's M): "
                 "its template is then out of date"});
  fields.Add(
      "missed_frames", missed_frames,
      {.min = 0,
       .max = 10'000,
       .unit = "frames",
       .reason = "a track that was not seen in so many frames running is still sought in the next, without a box "
                 "meanwhile: flicker, and short occlusions"});
  fields.Add("predict_motion", predict_motion,
             {.reason = "seek the points where the object's last motion would have brought them, also after a loss "
                        "(thesis, section 4.4), and before it has one, where the picture as a whole went; else where "
                        "they were last seen"});
  fields.Add("window_px", window_px,
             {.min = 5, .max = 101, .unit = "px", .reason = "side of Lucas and Kanade's window on each level"});
  fields.Add("pyramid_levels", pyramid_levels,
             {.min = 1,
              .max = 8,
              .reason = "each doubles the motion that can be followed: 4 reach some 50 px a frame beside what is "
                        "predicted"});
  fields.Add("forward_backward_px", forward_backward_px,
             {.min = 0.05,
              .max = 100,
              .unit = "px",
              .reason = "a point that is followed on and back again must end this near to where it began"});
  fields.Add(
      "least_likeness", least_likeness,
      {.min = -1,
       .max = 1,
       .reason = "normalised correlation of a point's patch with the template's, below which something else is seen "
                 "there; -1 follows whatever moves, and drifts"});
  fields.Add("patch_px", patch_px, {.min = 5, .max = 101, .unit = "px", .reason = "side of a point's patch"});
  fields.Add("noise_px", noise_px,
             {.min = 0.1, .max = 100, .unit = "px", .reason = "deviation of a followed point's place"});
  fields.Add(
      "shape_fraction", shape_fraction,
      {.min = 0,
       .max = 1,
       .reason = "how far the similarity may be wrong about an object that turns, as a share of its size (square "
                 "root of its outline's area)"});
  fields.Add("least_points", least_points,
             {.min = 3, .max = 10'000, .reason = "points that must move as one for the object to be seen"});
  fields.Add(
      "least_support", least_support,
      {.min = 0, .max = 1, .reason = "the same as a share of the template's points that should be in the frame"});
  fields.Add("least_in_view", least_in_view,
             {.min = 0,
              .max = 1,
              .reason = "share of the outline's area that must lie in the frame, else the object has left it"});
}

}  // namespace victorious

// track/: the parameters of RegionTracker (region_tracker.h) and of point tracking (flow.h). track_options.cc gives
// ranges, units and reasons of those that a user can set.
#pragma once

#include "victorious/base/options.h"

namespace victorious {

/// Pyramidal Lucas-Kanade (flow.h).
struct FlowOptions {
  int window_px = 15;  ///< side of the window on each pyramid level
  /// Each level doubles the motion that can be tracked: 4 allow about 50 px per frame relative to the prediction.
  int pyramid_levels = 4;
  double max_forward_backward_px = 1.0;  ///< maximum forward-backward error of a tracked point
};

struct TrackOptions {
  double dilation_factor = 1.5;  ///< the thesis's DILATION_FACTOR
  int unconfirmed_frames = 30;   ///< the thesis's M
  int missed_frames = 5;

  // Not user parameters from here on.
  FlowOptions flow;  ///< tests reduce the pyramid's levels
  /// Start the search for the points where the object's velocity predicts them, also after a loss (thesis,
  /// section 4.4), or for a new track where the global image motion predicts them; false, in tests: at their last
  /// positions.
  bool predict_motion = true;
  /// Minimum NCC of a point's patch with its patch in the template. -1, in experiments/steady_lock.cc, disables the
  /// check: the track then follows any motion and drifts.
  double min_ncc = 0.6;

  void ListFields(FieldList& fields);
};

}  // namespace victorious

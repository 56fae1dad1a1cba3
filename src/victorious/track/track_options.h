// track/: the parameters of RegionTracker (region_tracker.h) and of point tracking (flow.h). track_options.cc gives
// ranges, units and reasons.
#pragma once

#include "victorious/base/options.h"

namespace victorious {

struct TrackOptions {
  double dilation_factor = 1.5;  ///< the thesis's DILATION_FACTOR
  int unconfirmed_frames = 30;   ///< the thesis's M
  int missed_frames = 5;
  bool predict_motion = true;
  int window_px = 15;
  int pyramid_levels = 4;
  double forward_backward_px = 1.0;
  double min_ncc = 0.6;
  int patch_px = 13;
  double noise_px = 1.0;
  double shape_fraction = 0.02;
  int min_points = 4;
  double min_support = 0.2;
  double min_in_view = 0.3;

  void ListFields(FieldList& fields);
};

}  // namespace victorious

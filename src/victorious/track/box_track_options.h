// track/: the parameters of BoxTracker (box_tracker.h). box_track_options.cc gives ranges, units and reasons.
#pragma once

#include "victorious/base/options.h"

namespace victorious {

struct BoxTrackOptions {
  double window_factor = 5.0;
  double temporal_weight = 8.0;
  double velocity_learning_rate = 0.3;
  double scale_learning_rate = 0.025;
  double template_confidence = 0.85;
  double update_confidence = 0.6;
  double lost_confidence = 0.35;
  double redetect_confidence = 0.55;
  double min_in_view = 0.3;

  void ListFields(FieldList& fields);
};

}  // namespace victorious

// track/: the parameters of BoxTracker (box_tracker.h). box_track_options.cc gives ranges, units and reasons.
#pragma once

#include "victorious/base/options.h"

namespace victorious {

struct BoxTrackOptions {
  double window_factor = 5.0;
  double stay = 8.0;
  double velocity_rate = 0.3;
  double scale_rate = 0.025;
  double sure_trust = 0.85;
  double learn_trust = 0.6;
  double lost_trust = 0.35;
  double return_trust = 0.55;
  double least_in_view = 0.3;

  void ListFields(FieldList& fields);
};

}  // namespace victorious

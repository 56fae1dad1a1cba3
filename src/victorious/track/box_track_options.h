// track/: the parameters of BoxTracker (box_tracker.h). box_track_options.cc gives ranges, units and reasons.
//
// A confidence is 1 if the response's sharpness and the NCC with the templates are at their running means for this
// object.
#pragma once

#include "victorious/base/options.h"

namespace victorious {

struct BoxTrackOptions {
  double update_confidence = 0.6;
  double lost_confidence = 0.35;
  double redetect_confidence = 0.55;
  double min_in_view = 0.3;

  void ListFields(FieldList& fields);
};

}  // namespace victorious

// Parameters of data association: geolocation of objects, merging of tracklets, rejection of false alarms.
#pragma once

#include <memory>

#include "victorious/base/options.h"
#include "victorious/geolocate/locate_options.h"

namespace victorious {

struct ObjectOptions {
  double identity_gate_sigma = 3.5;
  double identity_slack_m = 0.5;
  double identity_farthest_m = 9.5;
  double flight_share = 0.3;
  double least_agreeing = 0.5;
  double motion_window_s = 5;
  double scale_allowance = 1.6;
  double floating_m = 15;
  double least_apart_m = 1.5;
  double same_pixels = 0.6;
  double false_share = 0.016;
  double middle_above_ground_m = 1.2;
  double middle_sigma_m = 1;
  LocateOptions locate = InVideo();      ///< without a ground constraint
  std::shared_ptr<const Ground> ground;  ///< under the objects, or null; given with the videos, not a parameter

  void ListFields(FieldList& fields);

  /// `locate` with the ground raised by the height of objects' centres, with the combined standard deviation.
  [[nodiscard]] LocateOptions LocateOnGround() const;

  /// Defaults for lines of sight from one video: a small position error from frame to frame, and a motion model
  /// selected from the data.
  static LocateOptions InVideo();
};

}  // namespace victorious

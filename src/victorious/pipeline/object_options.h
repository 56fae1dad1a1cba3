// The parameters of what makes objects of runs: where they are, which runs are one, which are false.
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
  LocateOptions locate = InVideo();      ///< without a ground
  std::shared_ptr<const Ground> ground;  ///< that objects stand on, or null: told with the videos, no parameter

  void ListFields(FieldList& fields);

  /// `locate` with the ground that the middle of objects is on: as far above `ground` as the parameters say.
  [[nodiscard]] LocateOptions LocateOnGround() const;

  /// Lines from one video err little from frame to frame; what they err more than told is measured.
  static LocateOptions InVideo();
};

}  // namespace victorious

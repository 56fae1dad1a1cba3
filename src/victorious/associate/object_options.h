// Parameters of data association: geolocation of objects, merging of tracklets, rejection of false alarms.
#pragma once

#include <memory>

#include "victorious/base/options.h"
#include "victorious/geolocate/locate_options.h"

namespace victorious {

struct ObjectOptions {
  double merge_gate_sigma = 3.5;
  double merge_slack_m = 0.5;
  double max_merge_distance_m = 9.5;
  double flight_error_fraction = 0.3;
  double min_inlier_fraction = 0.5;
  double motion_window_s = 5;
  double max_size_ratio = 1.6;
  double max_height_deviation_m = 15;
  double min_separation_m = 1.5;
  double occlusion_iou = 0.6;
  double false_alarm_rate = 0.016;
  double centre_height_m = 1.2;
  double centre_height_sigma_m = 1;
  LocateOptions locate = SingleVideoDefaults();  ///< without a ground constraint
  std::shared_ptr<const Ground> ground;          ///< under the objects, or null; given with the videos, not a parameter

  void ListFields(FieldList& fields);

  /// `locate` with the ground raised by the height of objects' centres, with the combined standard deviation.
  [[nodiscard]] LocateOptions LocateOnGround() const;

  /// Defaults for lines of sight from one video: a small position error from frame to frame, and a motion model
  /// selected from the data.
  static LocateOptions SingleVideoDefaults();
};

}  // namespace victorious

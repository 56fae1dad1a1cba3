// Parameters of data association: geolocation of objects, merging of tracklets, rejection of false alarms.
#pragma once

#include <array>
#include <memory>
#include <string>

#include "victorious/base/enum_text.h"
#include "victorious/base/options.h"
#include "victorious/place/geolocate/locate_options.h"

namespace victorious {

/// Standard deviation added to each place when two are compared, m: the apparent centres of two sides of an object
/// differ. Chosen, not fitted.
inline constexpr double kMergeSlack_m = 0.5;

/// Fraction of a flight's common errors that does not cancel between two places of that flight. Chosen, not fitted.
inline constexpr double kFlightErrorFraction = 0.3;

/// Two static objects whose centres are nearer than this coincide, m: vehicles are wider.
inline constexpr double kMinSeparation_m = 1.5;

/// Two CAD objects are in the same pixels if their boxes overlap by this (intersection over union) in half of the
/// frames of the one with fewer. Chosen, not fitted.
inline constexpr double kOcclusionIou = 0.6;

/// Where the sizes of telemetry's errors come from (telemetry_errors.h).
enum class ErrorSource {
  kSupposed,  ///< from `locate`
  kRows,      ///< those of rows are measured; those common to a flight are supposed, or larger if the rows' are
  kReceiver,  ///< those of rows are measured; those common to a flight are of the same class, if the rows are unfiltered
};

inline constexpr auto kErrorSourceTexts = std::to_array<EnumText<ErrorSource>>(
    {{ErrorSource::kSupposed, "supposed"}, {ErrorSource::kRows, "rows"}, {ErrorSource::kReceiver, "receiver"}});

struct ObjectOptions {
  double merge_gate_sigma = 3.5;
  double max_merge_distance_m = 9.5;
  double min_inlier_fraction = 0.5;
  double max_size_ratio = 1.6;
  double false_alarm_rate = 0.016;
  ErrorSource telemetry_errors = ErrorSource::kReceiver;
  LocateOptions locate = SingleVideoDefaults();  ///< without a ground constraint

  /// A moving object is placed by the observations of its last interval of this length, s: its velocity is constant
  /// only for a while. Not a user parameter; box_place.h sets its own.
  double motion_window_s = 5;
  /// An object whose height follows from its size only, and differs from the median height of the others by this or
  /// more, m, is rejected. Not a user parameter.
  double max_height_deviation_m = 15;
  /// Height of objects' centres above the given ground, m: half a vehicle's height; and its standard deviation, in
  /// addition to that of the ground. Not user parameters.
  double centre_height_m = 1.2;
  double centre_height_sigma_m = 1;
  std::shared_ptr<const Ground> ground;  ///< under the objects, or null; given with the videos. Not a user parameter
  /// Identifies `ground`: another text for another ground. Empty: fits on it are not kept. Not a user parameter.
  std::string ground_id;
  /// How the index keeps the parameters with the objects; empty: not. Not a user parameter.
  std::string kept_json;

  void ListFields(FieldList& fields);

  /// `locate` with the ground raised by the height of objects' centres, with the combined standard deviation.
  [[nodiscard]] LocateOptions LocateOnGround() const;

  /// Defaults for lines of sight from one video: a small position error from frame to frame, and a motion model
  /// selected from the data.
  static LocateOptions SingleVideoDefaults();
};

}  // namespace victorious

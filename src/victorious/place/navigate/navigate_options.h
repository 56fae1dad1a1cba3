// The parameters of landmark navigation.
#pragma once

#include "victorious/base/options.h"

namespace victorious {

/// Telemetry errors: an offset that drifts as a random walk, and noise per row.
struct TelemetryErrorOptions {
  double position_m = 10;
  double attitude_deg = 3;
  double position_drift_m = 0.5;
  double attitude_drift_deg = 0.15;

  void ListFields(FieldList& fields);
};

/// Motion model of the camera.
struct MotionOptions {
  double speed_m_s = 40;
  double speed_change_m_s = 5;
  double angular_rate_deg_s = 20;
  double angular_rate_change_deg_s = 20;

  void ListFields(FieldList& fields);
};

/// Errors that are common to all sightings of a landmark. Not user parameters: they are of the models and of how their
/// views are matched (ADR 0011). Chosen, not fitted.
struct LandmarkErrorOptions {
  double centre_m = 0.1;    ///< sigma of the apparent centre, in addition to the covariance of the given place
  double rotation_deg = 1;  ///< sigma of the apparent rotation; also of its tilt against the vertical
  /// Sightings of a landmark within this time have the same error and count as one: they match the same view, s.
  double correlation_s = 0.5;
};

struct NavigateOptions {
  TelemetryErrorOptions telemetry;
  MotionOptions motion;
  LandmarkErrorOptions landmark;  ///< Not a user parameter
  double gate_sigma = 5;

  void ListFields(FieldList& fields);
};

}  // namespace victorious

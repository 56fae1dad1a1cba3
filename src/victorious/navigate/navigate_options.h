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
  double position_noise_m = 0.05;
  double attitude_noise_deg = 0.05;

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

/// Errors that are common to all sightings of a landmark.
struct LandmarkErrorOptions {
  double centre_m = 0.1;
  double rotation_deg = 1;
  double correlation_s = 0.5;

  void ListFields(FieldList& fields);
};

struct NavigateOptions {
  TelemetryErrorOptions telemetry;
  MotionOptions motion;
  LandmarkErrorOptions landmark;
  double gate_sigma = 5;
  double max_hypothesis_sigma_m = 15;

  void ListFields(FieldList& fields);
};

}  // namespace victorious

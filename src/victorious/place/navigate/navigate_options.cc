#include "victorious/place/navigate/navigate_options.h"

namespace victorious {

void TelemetryErrorOptions::ListFields(FieldList& fields) {
  fields.Add("position_m", position_m,
             {.min = 1e-3,
              .max = 1e6,
              .unit = "m",
              .reason = "sigma of the initial offset of telemetry's positions, along each axis; sigmas "
                        "given by telemetry take precedence"});
  fields.Add("attitude_deg", attitude_deg,
             {.min = 1e-3,
              .max = 180,
              .unit = "deg",
              .reason = "sigma of the initial offset of telemetry's yaw, pitch and roll; sigmas given by "
                        "telemetry take precedence"});
  fields.Add("position_drift_m", position_drift_m,
             {.min = 0,
              .max = 1e3,
              .unit = "m",
              .reason = "sigma of the random walk of the position offset after one second; grows with "
                        "the square root of time"});
  fields.Add("attitude_drift_deg", attitude_drift_deg,
             {.min = 0,
              .max = 90,
              .unit = "deg",
              .reason = "sigma of the random walk of the attitude offset after one second"});
}

void MotionOptions::ListFields(FieldList& fields) {
  fields.Add("speed_m_s", speed_m_s,
             {.min = 1e-3, .max = 1e4, .unit = "m/s", .reason = "sigma of the camera's velocity, along each axis"});
  fields.Add("speed_change_m_s", speed_change_m_s,
             {.min = 1e-3,
              .max = 1e3,
              .unit = "m/s",
              .reason = "sigma of the random walk of the velocity after one second, along each axis: 5 "
                        "m/s in a tight circle"});
  fields.Add(
      "angular_rate_deg_s", angular_rate_deg_s,
      {.min = 1e-3, .max = 1e4, .unit = "deg/s", .reason = "sigma of the camera's angular rate, about each axis"});
  fields.Add("angular_rate_change_deg_s", angular_rate_change_deg_s,
             {.min = 1e-3,
              .max = 1e4,
              .unit = "deg/s",
              .reason = "sigma of the random walk of the angular rate after one second: a hand-held "
                        "camera shakes"});
}

void NavigateOptions::ListFields(FieldList& fields) {
  fields.AddGroup("telemetry_error", telemetry);
  fields.AddGroup("motion", motion);
  fields.Add("gate_sigma", gate_sigma,
             {.min = 1,
              .max = 100,
              .unit = "",
              .reason = "gate of the data association: a sighting with a larger residual, in sigmas, is "
                        "an outlier"});
}

}  // namespace victorious

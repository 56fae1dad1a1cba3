#include "victorious/navigate/navigate_options.h"

namespace victorious {

void TelemetryErrorOptions::ListFields(FieldList& fields) {
  fields.Add("position_m", position_m,
             {.min = 1e-3,
              .max = 1e6,
              .unit = "m",
              .reason = "sigma of the offset of telemetry's places along each axis; where telemetry tells its own, "
                        "that counts"});
  fields.Add("attitude_deg", attitude_deg,
             {.min = 1e-3,
              .max = 180,
              .unit = "deg",
              .reason = "sigma of the offset of telemetry's yaw, pitch and roll; where telemetry tells its own, that "
                        "counts"});
  fields.Add("position_drift_m", position_drift_m,
             {.min = 0,
              .max = 1e3,
              .unit = "m",
              .reason = "sigma of how far the places' offset drifts in a second; in more seconds, with their root"});
  fields.Add("attitude_drift_deg", attitude_drift_deg,
             {.min = 0, .max = 90, .unit = "deg", .reason = "the same of the attitude's offset"});
  fields.Add("position_noise_m", position_noise_m,
             {.min = 1e-3,
              .max = 1e3,
              .unit = "m",
              .reason = "sigma of a row's own error in its place, at least; how much more it is, the rows' scatter "
                        "tells"});
  fields.Add("attitude_noise_deg", attitude_noise_deg,
             {.min = 1e-3, .max = 90, .unit = "deg", .reason = "the same of its attitude"});
}

void MotionOptions::ListFields(FieldList& fields) {
  fields.Add("speed_m_s", speed_m_s,
             {.min = 1e-3, .max = 1e4, .unit = "m/s", .reason = "sigma of the camera's speed along each axis"});
  fields.Add("speed_change_m_s", speed_change_m_s,
             {.min = 1e-3,
              .max = 1e3,
              .unit = "m/s",
              .reason = "sigma of how much its speed changes in a second, along each axis: a tight circle's 5 m/s"});
  fields.Add("turn_deg_s", turn_deg_s,
             {.min = 1e-3, .max = 1e4, .unit = "deg/s", .reason = "sigma of how fast it turns, about each axis"});
  fields.Add("turn_change_deg_s", turn_change_deg_s,
             {.min = 1e-3,
              .max = 1e4,
              .unit = "deg/s",
              .reason = "sigma of how much that changes in a second: a hand's shake"});
}

void LandmarkErrorOptions::ListFields(FieldList& fields) {
  fields.Add("middle_m", middle_m,
             {.min = 1e-3,
              .max = 100,
              .unit = "m",
              .reason = "sigma of where the middle of a landmark seems to be, beside what is told of its place, the "
                        "same in all frames"});
  fields.Add("turn_deg", turn_deg,
             {.min = 1e-3,
              .max = 90,
              .unit = "deg",
              .reason = "the same of how it seems turned; it also stands upright no better than this"});
  fields.Add("correlation_s", correlation_s,
             {.min = 0,
              .max = 1e3,
              .unit = "s",
              .reason = "sightings of a landmark within so long err alike, and count as one: they rest on the same "
                        "view of its model"});
}

void NavigateOptions::ListFields(FieldList& fields) {
  fields.AddGroup("telemetry_error", telemetry);
  fields.AddGroup("motion", motion);
  fields.AddGroup("landmark", landmark);
  fields.Add("gate_sigma", gate_sigma,
             {.min = 1,
              .max = 100,
              .unit = "",
              .reason = "a sighting further than so many sigmas from where its landmark should be is set aside"});
  fields.Add("claim_sigma_m", claim_sigma_m,
             {.min = 0.1,
              .max = 1e4,
              .unit = "m",
              .reason = "a sighting that alone tells the camera's place no better has no say in which landmarks are "
                        "right"});
}

}  // namespace victorious

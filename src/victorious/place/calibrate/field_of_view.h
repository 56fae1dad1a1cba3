// Estimates the errors of the field of view and of the yaw that telemetry states, from the motion of the image.
//
// Where the camera flies straight, lines of sight alone do not determine it: ranges by apparent size and by
// triangulation are both proportional to the focal length f. But ground that is seen obliquely moves the faster the
// nearer it is:
//
//   shift(x) = f v / depth(x),   1 / depth(x) = (n_z + n_y y / f + n_x x / f) / height
//
// with the ground's normal n in the camera's frame, which the attitude gives. The relative change of the shift over the
// image is n_y / (n_z f), without the height of the ground. Where the camera turns, the turn gives f as well.
//
// Over each second, the mean shift and its gradient (image_flow.h) are compared with those of a plane that telemetry
// predicts. Unknown are ln f, the height above the ground in each second, and, with priors, the slope of the ground,
// and the yaw, pitch and roll of the camera: a slope towards the camera changes the shift in the same way as f does,
// which limits the accuracy to some 7 % at 37 degrees off nadir. From straight above nothing follows, nor from a camera
// that circles and looks at one point.
//
// Past a camera that flies straight, the ground moves opposite to the course, which the positions give. The direction
// in the image gives the yaw of the camera, but for its roll: a roll of half a degree is one of yaw of 0.6 at 37
// degrees off nadir. Lines of sight to parked objects say the same: with a wrong yaw, all of them seem to drive with
// one velocity. In a turn, positions that lag behind the attitude by a fraction of a second look like a wrong yaw; then
// nothing is said.
#pragma once

#include <optional>

#include "victorious/input/telemetry/camera_track.h"
#include "victorious/place/calibrate/time_offset.h"

namespace victorious {

/// An error of the focal length: the logarithm of its true value over that which follows from telemetry.
struct FocalMeasurement {
  double log_factor = 0;
  double sigma = 0;
};

/// An error of the yaw: telemetry's less the true one.
struct YawMeasurement {
  double error_rad = 0;
  double sigma_rad = 0;
};

struct CameraErrors {
  FocalMeasurement focal;
  std::optional<YawMeasurement> yaw;  ///< of a flight that is straight, and fast enough for a course
};

/// What the motion of the image says, without a prior. std::nullopt if it says nothing: too short, or telemetry without
/// attitudes or fields of view, or with noise that hides the motion from second to second, or the horizon is in view.
/// Cost: some 60 ms a minute of video, at ten pairs of frames a second.
[[nodiscard]] std::optional<CameraErrors> MeasureCameraErrors(const ImageMotions& seen,
                                                              const CameraTrajectory& cameras);

[[nodiscard]] inline std::optional<FocalMeasurement> FocalOf(const std::optional<CameraErrors>& errors) {
  return errors ? std::optional(errors->focal) : std::nullopt;
}

/// The error of the yaw, rad, to be subtracted, if it is significant and beyond what compasses are off.
[[nodiscard]] std::optional<double> SignificantYawError(const YawMeasurement& measured);

/// What is to be done about the field of view.
struct FieldOfViewVerdict {
  double wrong_probability = 0;  ///< that telemetry's field of view is wrong
  double log_factor = 0;         ///< correction of the focal length: 0 unless it is more likely wrong than right
  /// Standard deviation of the logarithm of the corrected focal length; larger where it takes that for a normal
  /// distribution of this sigma to contain 90 % of what is possible.
  double sigma = 0;
};

/// By Bayes' rule, with the prior of input/telemetry/focal_prior.h: one field of view in ten is wrong.
/// @param measured  std::nullopt: nothing is known but that
[[nodiscard]] FieldOfViewVerdict JudgeFieldOfView(const std::optional<FocalMeasurement>& measured);

}  // namespace victorious

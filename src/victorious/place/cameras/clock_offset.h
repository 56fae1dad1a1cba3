// Corrects the clock, the field of view and the yaw of a video's telemetry before a job, if the motion of the image
// contradicts them (place/calibrate/time_offset.h, place/calibrate/field_of_view.h).
#pragma once

#include <optional>
#include <span>
#include <string>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/base/warning_sink.h"
#include "victorious/place/calibrate/field_of_view.h"
#include "victorious/place/calibrate/time_offset.h"
#include "victorious/place/cameras/camera_states.h"

namespace victorious {

/// The offset to be added to telemetry's times, s. An estimate is used if it exceeds three standard errors and 0.05 s:
/// the time stamps of frames are no more exact than half an interval at ten frames a second. std::nullopt: the offset
/// is smaller, or unknown; the times stay as they are.
[[nodiscard]] std::optional<double> ClockCorrection(const TimeOffset& offset);

/// The standard deviation of the clock after the correction, s: that of the estimate with what is not corrected, or
/// `unknown_s` without an estimate, that of the prior.
[[nodiscard]] double ClockSigma(const TimeOffset& offset, double unknown_s);

/// What an offset that stays unknown means for places, in one line: why it does, what is assumed instead, and by how
/// many metres each second shifts them, which no line of sight contradicts. std::nullopt if it is known, or the camera
/// hovers, and for telemetry that gives no places.
/// @param prior  what is assumed, and what the errors of places contain; of a clock that is exact nothing is said
[[nodiscard]] std::optional<std::string> DescribeUnknownClock(const TimeOffset& offset,
                                                              std::span<const CameraState> states,
                                                              const ClockPrior& prior);

/// The motion of the image that the telemetry contradicts, in one line with numbers; std::nullopt if it does not.
[[nodiscard]] std::optional<std::string> DescribeContradiction(const TimeOffset& offset);

/// What is known of the field of view, in one line; std::nullopt if nothing speaks against it.
[[nodiscard]] std::optional<std::string> DescribeFieldOfView(const FieldOfViewVerdict& verdict);

/// The yaw that the motion of the image contradicts, in one line.
[[nodiscard]] std::string DescribeYaw(const YawMeasurement& wrong);

/// What the user gave in place of telemetry: it is used as it is.
struct GivenOfCamera {
  bool field_of_view = false;
  bool yaw = false;
};

[[nodiscard]] GivenOfCamera FindGiven(const TelemetryOptions& options);

/// Estimates the offset from the first 20 s of the video, within 4 s, and shifts the camera states if it is
/// significant; `warn` receives one line with the offset and its standard error. Without an estimate they are shifted
/// by the prior (place/calibrate/clock_prior.h), and `warn` receives DescribeUnknownClock. Telemetry that the motion of
/// the image contradicts is that of another flight: the states are forgotten, so that nothing gets a wrong place, and
/// `warn` receives DescribeContradiction. The states get the standard deviation of the clock
/// (CameraStates::SetClockSigma). Then the field of view is judged, and corrected if it is more likely wrong than
/// right; `warn` receives DescribeFieldOfView. The yaw is corrected if its error is significant; `warn` receives
/// DescribeYaw. No effect without states of the whole video, and on photos. A video whose frames cannot be read again
/// gives a warning.
/// @param impulse_fraction  as MeasureMotions
/// Errors: kCancelled. Cost: up to 200 frames are read and their motion is measured, some 15 ms each at 640 x 480.
[[nodiscard]] Status CorrectTelemetry(const std::string& video, double impulse_fraction, const GivenOfCamera& given,
                                      const CancelToken& cancel, const WarningSink& warn, CameraStates& cameras);

}  // namespace victorious

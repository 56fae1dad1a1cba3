// Estimates the time offset between a video and its telemetry by comparing the image motion with the motion that
// telemetry predicts:
//
//   measured motion(t) = f(camera(t - offset), camera(t + dt - offset), height above the ground) + bias + noise
//
// Each pair of frames gives the background's shift and rotation (track/camera_motion.h). f projects flat ground of
// unknown height through the camera at both times. The unknowns are the offset, one over the height, and a bias per
// motion component. They minimise a Huber loss: a grid search, then Gauss-Newton.
//
// The standard error is a sandwich estimate with residual blocks of 1 s, which may be correlated within. There is no
// offset if the camera's motion hardly changes, is periodic, or does not match the image motion. It is periodic if
// another offset explains the image as well up to the noise of the image and of telemetry.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/types.hpp>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/base/options.h"
#include "victorious/geometry/similarity.h"
#include "victorious/input/telemetry/camera_track.h"
#include "victorious/input/telemetry/telemetry.h"
#include "victorious/object/features/feature_extractor.h"
#include "victorious/place/calibrate/image_flow.h"

namespace victorious {

struct TimeOffsetOptions {
  double max_offset_s = 4;
  double max_duration_s = 60;

  void ListFields(FieldList& fields);
};

/// Parameters of reading telemetry and of estimating its offset.
struct TimedTelemetryOptions {
  TelemetryOptions telemetry;
  TimeOffsetOptions offset;
  double impulse_fraction = FeatureOptions().impulse_fraction;  ///< as FeatureOptions::impulse_fraction

  void ListFields(FieldList& fields);
};

/// Background motion from one frame to another.
struct ImageMotion {
  double from_s = 0;
  double to_s = 0;
  Similarity2 to_from;            ///< px
  std::optional<ImageFlow> flow;  ///< affine; std::nullopt if too few corners were tracked (FitImageFlow)
};

struct ImageMotions {
  std::vector<ImageMotion> motions;
  cv::Size image;  ///< px
};

/// The mean motion of the image that telemetry predicts nowhere near, over half a minute of it or less: telemetry of
/// another flight. Right, down, and turning (clockwise), of points halfway to the image corners.
struct ContradictedMotion {
  Eigen::Vector3d seen_px_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d predicted_px_s = Eigen::Vector3d::Zero();  ///< at the height of the ground that fits best
};

/// Why there is an offset, or none.
enum class TimeOffsetStatus {
  kOk,
  kNoAttitude,   ///< telemetry has no attitude or no field of view
  kFewPairs,     ///< too few pairs of frames with a measurable motion
  kNoOverlap,    ///< telemetry and video overlap too little in time
  kUncertain,    ///< the camera's motion changes too little: the standard error is too large
  kUnexplained,  ///< telemetry explains too little of the image motion: it may belong to another video
  kPeriodic,     ///< the motion is periodic: another offset fits as well
  kOutOfRange,   ///< the best offset is beyond the searched range
};

struct TimeOffset {
  TimeOffsetStatus status = TimeOffsetStatus::kOk;
  std::optional<double> offset_s;  ///< s, to be added to telemetry's times; empty unless kOk
  double sigma_s = 0;              ///< standard error of the offset, s
  double explained = 0;            ///< fraction of the image motion's variance that telemetry explains, 0 to 1
  std::size_t pairs = 0;           ///< number of frame pairs compared
  double best_s = 0;               ///< best fit, s, also where it is rejected
  double other_s = 0;              ///< kPeriodic: the other offset that fits as well, s
  double max_offset_s = 0;         ///< searched range, s
  /// Without an offset only: a steady flight tells no offset, but whether it is this one.
  std::optional<ContradictedMotion> contradicted;
};

/// Measures the image motion of the video's first `max_duration_s`. Errors: those of VideoReader; kCancelled.
/// @param impulse_fraction  impulse noise fraction of the frames (RemoveImpulses)
/// Cost: some 10 ms per pair at 640 x 480, and reading.
[[nodiscard]] Expected<ImageMotions> MeasureMotions(const std::string& video, const TimeOffsetOptions& options,
                                                    double impulse_fraction, const CancelToken& cancel);

/// Estimates the offset. Deterministic. Cost: half a second for a minute of video.
/// @param cameras  telemetry's states, on the video's clock up to the offset
TimeOffset EstimateTimeOffset(const ImageMotions& seen, const CameraTrajectory& cameras,
                              const TimeOffsetOptions& options);

/// The reason why there is no offset; "ok" if there is one.
[[nodiscard]] std::string DescribeStatus(const TimeOffset& offset);

/// The result as one line of text.
[[nodiscard]] std::string Describe(const TimeOffset& offset);

}  // namespace victorious

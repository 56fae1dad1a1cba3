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
// offset if the camera's motion hardly changes, is periodic, or does not match the image motion.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core/types.hpp>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/base/options.h"
#include "victorious/geometry/similarity.h"
#include "victorious/telemetry/camera_track.h"
#include "victorious/telemetry/telemetry.h"

namespace victorious {

struct TimeOffsetOptions {
  double max_offset_s = 2;
  double min_pair_interval_s = 0.1;
  double max_duration_s = 60;
  double min_sigma_s = 0.002;
  double max_sigma_s = 0.1;
  double min_explained_variance = 0.5;

  void ListFields(FieldList& fields);
};

/// Parameters of reading telemetry and of estimating its offset.
struct TimedTelemetryOptions {
  TelemetryOptions telemetry;
  TimeOffsetOptions offset;

  void ListFields(FieldList& fields) {
    telemetry.ListFields(fields);
    fields.AddGroup("offset", offset);
  }
};

/// Background motion from one frame to another.
struct ImageMotion {
  double from_s = 0;
  double to_s = 0;
  Similarity2 to_from;  ///< px
};

struct ImageMotions {
  std::vector<ImageMotion> motions;
  cv::Size image;  ///< px
};

struct TimeOffset {
  std::optional<double> offset_s;  ///< s, to be added to telemetry's times
  double sigma_s = 0;              ///< standard error of the offset, s
  double explained = 0;            ///< fraction of the image motion's variance that telemetry explains, 0 to 1
  std::size_t pairs = 0;           ///< number of frame pairs compared
  std::string status;              ///< "ok", or the reason why there is no offset
};

/// Measures the image motion of the video's first `max_duration_s`. Errors: those of VideoReader; kCancelled.
/// Cost: some 10 ms per pair at 640 x 480, and reading.
Expected<ImageMotions> MeasureMotions(const std::string& video, const TimeOffsetOptions& options,
                                      const CancelToken& cancel);

/// Estimates the offset. Deterministic. Cost: half a second for a minute of video.
/// @param cameras  telemetry's states, on the video's clock up to the offset
TimeOffset EstimateTimeOffset(const ImageMotions& seen, const CameraTrajectory& cameras,
                              const TimeOffsetOptions& options);

/// The result as one line of text.
[[nodiscard]] std::string Describe(const TimeOffset& offset);

}  // namespace victorious

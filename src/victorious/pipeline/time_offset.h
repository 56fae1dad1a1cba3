// By how much a video's telemetry is early or late, told by the picture: as the camera turns and flies, the ground
// moves through the picture, and telemetry says how it should.
//
//   measured motion(t) = f(camera(t - offset), camera(t + dt - offset), height above the ground) + bias + noise
//
// Each pair of frames gives the background's shift and turn (track/camera_motion.h); f sees the ground, flat and at an
// unknown height, through the camera at both moments. Offset, height and the bias of each of the three components are
// those that leave the least, in Huber's sense: sought over a grid, then by Gauss and Newton's method.
//
// The standard error holds what is left over as it is: blocks of it, of a second each, may be alike within. Where the
// camera's motion hardly changes, or comes again after a while, or is not that of the picture, there is no offset.
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
  double most_s = 2;
  double pair_s = 0.1;
  double watch_s = 60;
  double least_sigma_s = 0.002;
  double largest_sigma_s = 0.1;
  double least_explained = 0.5;

  void ListFields(FieldList& fields);
};

/// How telemetry is read, and its offset estimated.
struct TimedTelemetryOptions {
  TelemetryOptions telemetry;
  TimeOffsetOptions offset;

  void ListFields(FieldList& fields) {
    telemetry.ListFields(fields);
    fields.AddGroup("offset", offset);
  }
};

/// How the background moved through the picture from one frame to another.
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
  std::optional<double> offset_s;  ///< to be added to telemetry's times
  double sigma_s = 0;              ///< of it, where there is one
  double explained = 0;            ///< the share of the motion's variance that telemetry tells, 0 to 1
  std::size_t pairs = 0;           ///< of frames that were compared
  std::string status;              ///< "ok", or why there is none
};

/// Of the video's first `watch_s`. Errors: those of VideoReader; kCancelled.
/// Cost: some 10 ms a pair at 640 x 480, and reading.
Expected<ImageMotions> MeasureMotions(const std::string& video, const TimeOffsetOptions& options,
                                      const CancelToken& cancel);

/// @param cameras  telemetry's states, on the video's clock but for the offset
/// Deterministic. Cost: half a second for a minute of video.
TimeOffset EstimateTimeOffset(const ImageMotions& seen, const CameraTrack& cameras, const TimeOffsetOptions& options);

/// In plain words, one line.
[[nodiscard]] std::string Describe(const TimeOffset& offset);

}  // namespace victorious

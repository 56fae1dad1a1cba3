// Estimates the sun's direction in a video, so that CAD models are searched for with templates relit for it: by an
// ephemeris if telemetry has a clock, else by a consensus of sampled frames on which relit templates match best.
#pragma once

#include <functional>
#include <optional>

#include <opencv2/core/mat.hpp>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/base/options.h"
#include "victorious/base/warning_sink.h"
#include "victorious/geometry/sun.h"
#include "victorious/input/telemetry/camera_track.h"
#include "victorious/input/video/video_reader.h"
#include "victorious/object/features/feature_extractor.h"
#include "victorious/search/recognize/recognizer.h"
#include "victorious/types/frame.h"
#include "victorious/types/frame_conditions.h"

namespace victorious {

/// Whether CAD models are searched for with templates relit for the sun's direction.
enum class SunSearch {
  kAuto,  ///< if telemetry has the camera's attitude and the direction can be found
  kOff,   ///< never: templates for diffuse light only
};

struct SunDirectionOptions {
  SunSearch sun = SunSearch::kAuto;

  void ListFields(FieldList& fields);
};

/// Search conditions of a frame: the vertical in the camera's frame and the sun's direction relative to the camera's
/// yaw. Empty if the attitude or the field of view is unknown.
[[nodiscard]] FrameConditions MakeFrameConditions(const std::optional<CameraState>& camera, const cv::Size& size_px,
                                                  const std::optional<Sun>& sun);

/// The sun's direction (azimuth from north) by the ephemeris at the first state with a clock. std::nullopt without a
/// clock, and for a sun too low to cast hard light.
[[nodiscard]] std::optional<Sun> SunByClock(const CameraTrajectory& cameras);

/// Input of EstimateSunDirection. The references outlive it.
struct SunDirectionInput {
  const CameraTrajectory& cameras;
  const Recognizer& recognizer;
  const FeatureExtractor& extractor;
  const SunDirectionOptions& options;
  int threads = 0;               ///< 0: one per processor
  bool only_if_certain = false;  ///< three estimates must agree, with their evidence; two at the end do not suffice
  /// The image of a frame that is searched, of any size (jobs/index/search_scale.h); empty: that of the frame.
  std::function<cv::Mat(const Frame& frame)> searched_image = {};
};

/// The sun's direction (azimuth from north). Taken from the ephemeris if telemetry has a clock. Otherwise frames are
/// sampled over the whole video (Recognizer::EstimateSun) until three estimates agree within 30 degrees and have 30
/// decades of evidence, twice that of all others; at the end two agreeing estimates of most evidence suffice, or one if
/// it is the only one. The evidence is the gain over diffuse light. std::nullopt at night, under overcast, or if no
/// frame determines it. Deterministic.
/// @param reader  at its first frame; reads as far as needed, and seeks in a long video
/// @param warn    receives read errors, which end the sampling, and errors of feature extraction, which skip a frame
/// Errors: kCancelled.
[[nodiscard]] Expected<std::optional<Sun>> EstimateSunDirection(const SunDirectionInput& input, VideoReader& reader,
                                                                const CancelToken& cancel, const WarningSink& warn);

}  // namespace victorious

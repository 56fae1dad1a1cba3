// Where the sun stands in a video, so that objects are sought as it lights them: by the telemetry's clock, or by how
// some object in some frames is lit.
#pragma once

#include <optional>
#include <string>

#include <opencv2/core/types.hpp>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/base/options.h"
#include "victorious/features/feature_extractor.h"
#include "victorious/geometry/sun.h"
#include "victorious/recognize/recognizer.h"
#include "victorious/telemetry/camera_track.h"
#include "victorious/types/frame_conditions.h"
#include "victorious/video/video_reader.h"

namespace victorious {

struct DaylightOptions {
  std::string sun = "auto";
  int least_frames = 6;
  int most_frames = 200;

  void ListFields(FieldList& fields);
};

/// What a frame is searched with.
[[nodiscard]] FrameConditions ConditionsOf(const std::optional<CameraState>& camera, const cv::Size& size_px,
                                           const std::optional<Sun>& sun);

/// What a survey works on. The references outlive it.
struct DaylightSurvey {
  const CameraTrack& cameras;
  const Recognizer& recognizer;
  const FeatureExtractor& extractor;
  const DaylightOptions& options;
};

/// Where the sun stands, by the clock if the telemetry has one. Else frames from all over the video are asked
/// (Recognizer::FindSun), until three agree; two are enough at the end, and one if no other answers. Nothing at night,
/// under clouds, or where nothing tells. Deterministic.
/// @param reader  from its beginning; is read as far as need be
/// Errors: kCancelled. A video that cannot be read further says what its search says.
Expected<std::optional<Sun>> FindDaylight(const DaylightSurvey& survey, VideoReader& reader, const CancelToken& cancel);

}  // namespace victorious

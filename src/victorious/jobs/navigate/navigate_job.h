// Landmark navigation over a video. Landmarks are recognised in full frames, tracked from frame to frame and
// re-recognised in their regions of interest (follower.h). Their sightings, and telemetry if there is any, are the
// input of the estimation in navigate/.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/base/options.h"
#include "victorious/base/warning_sink.h"
#include "victorious/input/telemetry/telemetry.h"
#include "victorious/jobs/index/index_options.h"
#include "victorious/jobs/navigate/landmark_list.h"
#include "victorious/object/features/feature_extractor.h"
#include "victorious/place/calibrate/sun_direction.h"
#include "victorious/place/navigate/navigate.h"
#include "victorious/place/observe/landmark_sighting.h"
#include "victorious/place/observe/object_pose.h"
#include "victorious/search/follow/follower.h"
#include "victorious/search/recognize/recognizer.h"

namespace victorious {

/// The options of landmark navigation; `victorious params navigate` prints the user parameters.
struct NavigateVideoOptions {
  NavigateVideoOptions();

  VideoOptions video;
  FeatureOptions features = LowContrastFeatureOptions();
  RecognizeOptions recognize;
  SunDirectionOptions sun_direction;
  TelemetryOptions telemetry;
  ObservationOptions observation;  ///< of landmarks. Not a user parameter
  FollowOptions follow;
  LandmarkListOptions list;
  NavigateOptions navigate;
  LandmarkSightingOptions sighting;  ///< Not a user parameter
  bool second_pass = true;  ///< search again with the estimated attitude if telemetry has none, or one off by a degree
  int every = 30;           ///< frames between full-frame searches while a landmark is tracked
  int lost_every = 5;       ///< frames between full-frame searches while none is tracked

  void ListFields(FieldList& fields);
};

struct NavigateJob {
  std::string video;
  std::string landmarks;                 ///< path of an index, or of a list (landmark_list.h)
  std::optional<std::string> telemetry;  ///< telemetry file; if not given, that of the video
};

struct NavigationResult {
  Navigation navigation;
  std::vector<CameraState> states;      ///< per localised frame, with field of view and lens
  std::vector<Landmark> landmarks;      ///< those whose model was searched for
  std::vector<std::int64_t> sightings;  ///< number of accepted sightings per landmark
  std::int64_t rejected_sightings = 0;  ///< number of rejected sightings
  std::int64_t frames = 0;              ///< number of frames read
  double tracked_ms = 0;                ///< median wall time of a frame with landmarks that is tracked only, ms
  double tracked_cpu_ms = 0;            ///< median processor time of such a frame, all threads, ms
  double estimate_ms = 0;               ///< time of the estimation per frame, ms
};

/// Estimates the camera's trajectory over a video.
/// @param models  candidates; models without a landmark are dropped
/// Errors: kInvalidArgument for options out of range, a list without landmarks, no landmark with a known model, or an
/// unknown field of view; those of the video, the telemetry and the index; kCancelled.
[[nodiscard]] Expected<NavigationResult> NavigateVideo(const NavigateJob& job, std::vector<ObjectModel> models,
                                                       const NavigateVideoOptions& options, const CancelToken& cancel,
                                                       const WarningSink& warn);

/// The telemetry table with additional columns (docs/formats/navigate.md).
std::string ToCsv(const NavigationResult& result);

}  // namespace victorious

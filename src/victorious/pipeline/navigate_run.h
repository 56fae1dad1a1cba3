// Landmark navigation over a video: landmarks are recognised in whole frames, followed from frame to frame and now and
// then recognised again in their regions (follower.h); what they tell goes to navigate/ with the telemetry, if any.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/base/options.h"
#include "victorious/features/feature_extractor.h"
#include "victorious/navigate/navigate.h"
#include "victorious/pipeline/daylight.h"
#include "victorious/pipeline/follower.h"
#include "victorious/pipeline/index_options.h"
#include "victorious/pipeline/landmark_list.h"
#include "victorious/pipeline/landmark_sighting.h"
#include "victorious/pipeline/stance.h"
#include "victorious/pipeline/warning_sink.h"
#include "victorious/recognize/recognizer.h"
#include "victorious/telemetry/telemetry.h"

namespace victorious {

struct NavigateRunOptions {
  NavigateRunOptions();

  VideoOptions video;
  FeatureOptions features = FaintFeatures();
  RecognizeOptions recognize;
  DaylightOptions daylight;
  TelemetryOptions telemetry;
  SightOptions sight;
  FollowOptions follow;
  LandmarkListOptions list;
  NavigateOptions navigate;
  SightingOptions sighting;
  bool second_look = true;
  int every = 30;
  int lost_every = 5;

  void ListFields(FieldList& fields);
};

struct NavigateJob {
  std::string video;
  std::string landmarks;                 ///< an index, or a list
  std::optional<std::string> telemetry;  ///< unless given, that of the video
};

struct NavigationRun {
  Navigation navigation;
  std::vector<CameraState> states;      ///< one a frame, with field of view and lens; none where nothing tells a place
  std::vector<Landmark> landmarks;      ///< of the models that were searched for
  std::vector<std::int64_t> sightings;  ///< of each: frames in which it was believed
  std::int64_t unbelieved = 0;          ///< sightings that were not
  std::int64_t frames = 0;              ///< read
  double tracked_ms = 0;                ///< median time of a frame that was not searched as a whole, landmarks in it
  double tracked_cpu_ms = 0;            ///< of it, processor time of all threads
  double estimate_ms = 0;               ///< time of the estimation, a frame
};

/// @param models  all that may be searched for; those of no landmark are not
/// Errors: kInvalidArgument for options out of range, a list without a landmark, no landmark of a known model, no field
/// of view; those of the video, the telemetry and the index; kCancelled.
Expected<NavigationRun> NavigateVideo(const NavigateJob& job, std::vector<ObjectModel> models,
                                      const NavigateRunOptions& options, const CancelToken& cancel,
                                      const WarningSink& warn);

/// The telemetry's table with more columns (docs/formats/navigate.md).
std::string ToCsv(const NavigationRun& run);

}  // namespace victorious

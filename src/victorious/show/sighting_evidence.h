// Why a sighting was reported: makes the features of its frame again, as the search made them, and matches them with
// its view (search/recognize/match_evidence.h). In: what the store keeps of a sighting, its frame and its model. Out:
// the matches stage by stage.
//
// Between full-frame searches the features are those of the region around the sighting; the search took the region that
// its track predicted, which differs by some pixels. The sun is that of the ephemeris; of telemetry without a clock
// only the attitude is used. A correction of the telemetry's clock that the search made is not stored, and not made
// here: by seconds of it, the attitude is that of another moment.
#pragma once

#include <string>

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"
#include "victorious/input/telemetry/telemetry.h"
#include "victorious/place/cameras/camera_states.h"
#include "victorious/search/recognize/match_evidence.h"
#include "victorious/types/index_records.h"
#include "victorious/types/object_model.h"

namespace victorious {

/// The telemetry options of a search, for CameraStates::Load. Error: that of ExplainSighting.
/// @param options_json  SearchRecord::options_json
[[nodiscard]] Expected<TelemetryOptions> TelemetryOptionsOf(const std::string& options_json);

/// @param options_json  SearchRecord::options_json of the sighting's video and model
/// @param model         that was searched for
/// @param grey          the sighting's frame, CV_8UC1
/// @param cameras       of the sighting's video
/// Errors: kUnsupported for options of another version; kInvalidArgument for a view that the model does not have; those
/// of feature extraction and RelitTemplateSource.
/// Cost: that of searching one frame for one view.
[[nodiscard]] Expected<MatchEvidence> ExplainSighting(const SightingRecord& sighting, const std::string& options_json,
                                                      const ObjectModel& model, const cv::Mat& grey,
                                                      const CameraStates& cameras);

}  // namespace victorious

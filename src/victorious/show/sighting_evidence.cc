#include "victorious/show/sighting_evidence.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include <nlohmann/json.hpp>

#include "victorious/base/json.h"
#include "victorious/input/image/impulse_noise.h"
#include "victorious/jobs/index/index_options.h"
#include "victorious/jobs/model_engine.h"
#include "victorious/object/features/feature_extractor.h"
#include "victorious/object/model/relit_views.h"
#include "victorious/place/calibrate/sun_direction.h"
#include "victorious/search/follow/full_search_schedule.h"
#include "victorious/search/follow/region_features.h"

namespace victorious {
namespace {

Expected<IndexOptions> ParseSearchOptions(const std::string& options_json) {
  IndexOptions options;
  Expected<nlohmann::json> json = ParseStrictJson(options_json);
  FieldList fields;
  options.ListSearchFields(fields);
  if (json && json->is_object()) {
    json->erase("searched");  // the interval of time, which is no option
    const Status status = SetFromJson(*json, fields.fields());
    if (status) return options;
  }
  return Fail(ErrorCode::kUnsupported,
              "the search was made with the options of another version: search the video again with --redo to see its "
              "evidence");
}

// True if a search with these options may search the whole of the frame, which depends on the motion of the image, too;
// without tracking it searches no other frames.
bool MayBeWholeFrame(std::int64_t frame, const IndexOptions& options) {
  const int every = std::max(1, options.every);
  return !options.follow.enabled || IsFullSearchFrame(frame, every, options.follow) ||
         IsFullSearchFrame(frame, PartInterval(every), options.follow);
}

// The features that the sighting was searched for in: of the whole frame, or of the region around it.
Expected<FeatureSet> SearchedFeatures(const SightingRecord& sighting, const cv::Mat& grey,
                                      const IndexOptions& options) {
  VICTORIOUS_ASSIGN_OR_RETURN(const auto extractor, MakeFeatureExtractor(options.features));
  if (MayBeWholeFrame(sighting.frame, options)) return extractor->Extract(grey);
  const double margin = (options.follow.track.dilation_factor - 1) / 2;  // of the box, on each side
  const Box& box = sighting.box;
  const Box region{box.x - margin * box.width, box.y - margin * box.height, (1 + 2 * margin) * box.width,
                   (1 + 2 * margin) * box.height};
  return FeaturesIn(RemoveImpulses(grey, options.features.impulse_fraction), region, *extractor);
}

}  // namespace

Expected<TelemetryOptions> TelemetryOptionsOf(const std::string& options_json) {
  VICTORIOUS_ASSIGN_OR_RETURN(const IndexOptions options, ParseSearchOptions(options_json));
  return options.telemetry;
}

Expected<MatchEvidence> ExplainSighting(const SightingRecord& sighting, const std::string& options_json,
                                        const ObjectModel& model, const cv::Mat& grey, const CameraStates& cameras) {
  VICTORIOUS_ASSIGN_OR_RETURN(IndexOptions options, ParseSearchOptions(options_json));
  VICTORIOUS_RETURN_IF_ERROR(AdoptEngineOfModels({&model, 1}, options.features, {}));
  VICTORIOUS_ASSIGN_OR_RETURN(const FeatureSet features, SearchedFeatures(sighting, grey, options));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto relit_templates, MakeRelitViews(model));
  std::optional<Sun> sun;
  if (options.sun_direction.sun != SunSearch::kOff && cameras.trajectory() != nullptr) {
    sun = SunByClock(*cameras.trajectory());
  }
  return GatherEvidence(features, MakeFrameConditions(cameras.At(sighting.time_s), grey.size(), sun), model,
                        relit_templates.get(), static_cast<std::size_t>(sighting.view_index), sighting.box,
                        options.recognize);
}

}  // namespace victorious

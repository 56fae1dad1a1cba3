// The JSON of the API's resources (api/openapi.json is their description).
#pragma once

#include "victorious/apps/serve/base_map.h"
#include "victorious/apps/serve/camera_path.h"
#include "victorious/apps/serve/index_view.h"
#include "victorious/search/recognize/match_evidence.h"
#include "victorious/store/account_store.h"
#include "victorious/store/job_queue.h"
#include "victorious/types/json_values.h"

namespace victorious {

/// Null for an empty review.
[[nodiscard]] Json ReviewToJson(const Review& review);

[[nodiscard]] Json DecisionsToJson(const std::vector<Review>& decisions);

[[nodiscard]] Json ObjectToJson(const TriageObject& listed, const IndexLists& lists);

/// The evidence that the store has of an object, as the schema ObjectEvidence; null if it has none, or one of an older
/// version that lacks a key.
[[nodiscard]] Json ObjectEvidenceToJson(const std::string& text);

[[nodiscard]] Json CountsToJson(const ObjectCounts& counts);

[[nodiscard]] Json SightingToJson(const SightingRecord& sighting);

/// At most 2000 matches, those that passed most stages.
/// @param view    of the model, that the sighting matches
/// @param region  of the frame around the sighting, px
[[nodiscard]] Json EvidenceToJson(const MatchEvidence& evidence, const SightingRecord& sighting, const ModelView& view,
                                  const Box& region);

/// @param sightings  the best ones of the model's best objects
[[nodiscard]] Json ModelViewsToJson(const ObjectModel& model, Json sightings);

/// @param missing  why the video's file cannot be read; empty: it can
/// @param has_copy  there is a copy that browsers play
/// @param with_searches  how far it was searched for each model
[[nodiscard]] Json VideoToJson(const VideoRecord& video, const IndexLists& lists, const std::string& missing,
                               bool has_copy, bool with_searches);

/// @param index       its file
/// @param can_review  the index can be written, and who asks may decide
/// @param has_views   images of the models' views can be had
/// @param has_jobs    videos and models can be added
/// @param categories  the category model; empty: none
[[nodiscard]] Json ProjectToJson(const std::string& name, const IndexLists& lists, const ObjectCounts& counts,
                                 bool can_review, bool has_views, bool has_jobs,
                                 const std::filesystem::path& categories, const BaseMap& base_map);

[[nodiscard]] Json CameraPathToJson(const CameraPath& path);

/// What a job is about: the name of a video or a model.
[[nodiscard]] std::string JobTitle(const JobRecord& job);
/// Why a live source cannot be read tells what answers at an address, which is for administrators.
enum class SourceReasons { kHidden, kShown };
/// @param now_us  microseconds since 1970, for the time that is left
[[nodiscard]] Json JobToJson(const JobRecord& job, std::int64_t now_us, SourceReasons reasons = SourceReasons::kHidden);
[[nodiscard]] Json JobsToJson(const std::vector<JobRecord>& jobs, std::int64_t now_us,
                              SourceReasons reasons = SourceReasons::kHidden);

[[nodiscard]] Json AuditToJson(const std::vector<AuditRecord>& records);

/// The horizontal 90 % confidence ellipse of a covariance: half axes and the direction of the longer one.
struct EllipseAxes {
  double semi_major_m = 0;
  double semi_minor_m = 0;
  double azimuth_rad = 0;  ///< of the longer axis, clockwise from north, [0, pi)
};
[[nodiscard]] EllipseAxes ComputeEllipseAxes(const Eigen::Matrix3d& covariance_enu_m2);

}  // namespace victorious

// Hypotheses of data association: tracklets that may be one object, and their agglomerative merging.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "victorious/associate/object_options.h"
#include "victorious/associate/object_place.h"
#include "victorious/associate/observed_tracklet.h"

namespace victorious {

/// Tracklets that may be one object.
struct ObjectHypothesis {
  std::vector<const ObservedTracklet*> tracklets;  ///< by id; at least one
  ObjectPlace estimate;                            ///< place for the comparison with others of its flight
  std::optional<ObjectPlace> absolute;             ///< see AbsolutePlace()
};

/// The id of the object: that of its first tracklet.
[[nodiscard]] std::int64_t ObjectId(const ObjectHypothesis& hypothesis);

/// The bearing observations of all tracklets, by time.
[[nodiscard]] std::vector<BearingObservation> CollectObservations(const ObjectHypothesis& hypothesis);

[[nodiscard]] bool IsInOneVideo(const ObjectHypothesis& hypothesis);
[[nodiscard]] bool HasCommonVideo(const ObjectHypothesis& a, const ObjectHypothesis& b);

/// Estimates the place of a hypothesis (object_place.h).
[[nodiscard]] ObjectPlace EstimatePlace(const ObjectHypothesis& hypothesis, ObjectOptions options,
                                        double common_fraction);

/// The place with all errors of its flight, for the comparison with objects of other flights, whose errors are
/// independent. Estimated by the first call, which is not thread-safe.
const ObjectPlace& AbsolutePlace(ObjectHypothesis& hypothesis, const ObjectOptions& options);

/// Merges the tracklets of one model, nearest pair (Mahalanobis) first, until no pair passes the gates
/// (associate_objects.h). Cost: two fits a tracklet and one a merge; a distance for each pair of one video and for each
/// pair of static ones within `max_merge_distance_m`.
/// @param tracklets  by id; must outlive the result
/// @return by id
[[nodiscard]] std::vector<ObjectHypothesis> MergeTracklets(const std::vector<const ObservedTracklet*>& tracklets,
                                                           const ObjectOptions& options);

}  // namespace victorious

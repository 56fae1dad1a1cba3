// Hypotheses of data association: tracklets that may be one object, and their agglomerative merging.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "victorious/associate/joint_motion.h"
#include "victorious/associate/object_options.h"
#include "victorious/associate/object_place.h"
#include "victorious/associate/observed_tracklet.h"

namespace victorious {

class Fits;

/// Tracklets that may be one object.
struct ObjectHypothesis {
  std::vector<const ObservedTracklet*> tracklets;  ///< by id; at least one
  ObjectPlace estimate;                            ///< place for the comparison with others of its flight (fits.h)
  std::optional<ObjectPlace> absolute;             ///< see AbsolutePlace()
};

/// The id of the object: that of its first tracklet.
[[nodiscard]] std::int64_t ObjectId(const ObjectHypothesis& hypothesis);

/// The bearing observations of all tracklets, by time.
[[nodiscard]] std::vector<BearingObservation> CollectObservations(const ObjectHypothesis& hypothesis);

[[nodiscard]] bool IsInOneVideo(const ObjectHypothesis& hypothesis);
[[nodiscard]] bool HasCommonVideo(const ObjectHypothesis& a, const ObjectHypothesis& b);

/// Estimates the place of a hypothesis (object_place.h) from the content of its tracklets.
/// @param size_ratio  as for EstimatePlace of observations
[[nodiscard]] ObjectPlace EstimatePlace(const ObjectHypothesis& hypothesis, ObjectOptions options,
                                        double common_fraction,
                                        const std::optional<std::optional<SizeRatio>>& size_ratio = std::nullopt);

/// True if the tracklets have places that move.
[[nodiscard]] bool IsMoving(const ObjectHypothesis& hypothesis);

/// The tracklets of each video as a hypothesis of its own, by video; with the estimate, but not the absolute place.
[[nodiscard]] std::vector<ObjectHypothesis> SplitByVideo(const ObjectHypothesis& hypothesis, Fits& fits);

/// A hypothesis of one video for joint_motion.h. std::nullopt if it has no place, or its video no UTC.
[[nodiscard]] std::optional<ObjectInFlight> MakeObjectInFlight(ObjectHypothesis& of_one_video, Fits& fits);

/// The place with all errors of its flight, for the comparison with objects of other flights, whose errors are
/// independent. Taken from `fits` by the first call.
const ObjectPlace& AbsolutePlace(ObjectHypothesis& hypothesis, Fits& fits);

/// Merges the tracklets of one model, nearest pair (Mahalanobis) first, until no pair passes the gates
/// (associate_objects.h). Cost: two fits a tracklet and one a merge, and a distance for each pair of static ones within
/// `max_merge_distance_m`, for each pair of one video of which one moves, and for each pair of videos of one time of
/// which one moves; other pairs of one video some nanoseconds each.
/// @param tracklets  by id; must outlive the result
/// @return by id
[[nodiscard]] std::vector<ObjectHypothesis> MergeTracklets(const std::vector<const ObservedTracklet*>& tracklets,
                                                           Fits& fits);

}  // namespace victorious

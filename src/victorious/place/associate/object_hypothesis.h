// Hypotheses of data association: tracklets that may be one object, and their agglomerative merging within a flight.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "victorious/place/associate/object_options.h"
#include "victorious/place/associate/object_place.h"
#include "victorious/place/associate/observed_tracklet.h"

namespace victorious {

class Fits;
class LinkConstraints;

/// Tracklets that may be one object.
struct ObjectHypothesis {
  std::vector<const ObservedTracklet*> tracklets;  ///< by id; at least one
  ObjectPlace estimate;  ///< of one flight: place for the comparison with others of it (fits.h); else of all flights
  std::optional<ObjectPlace> absolute;  ///< see AbsolutePlace()
};

/// The id of the object: that of its first tracklet.
[[nodiscard]] std::int64_t ObjectId(const ObjectHypothesis& hypothesis);

/// The video of a hypothesis of one flight.
[[nodiscard]] std::int64_t VideoOf(const ObjectHypothesis& hypothesis);

/// The bearing observations of all tracklets, by time.
[[nodiscard]] std::vector<BearingObservation> CollectObservations(const ObjectHypothesis& hypothesis);

/// Estimates the place of a hypothesis of one flight (object_place.h) from the content of its tracklets.
/// @param size_ratio  as for EstimatePlace of observations
[[nodiscard]] ObjectPlace EstimatePlace(const ObjectHypothesis& hypothesis, ObjectOptions options,
                                        double common_fraction,
                                        const std::optional<std::optional<SizeRatio>>& size_ratio = std::nullopt);

/// Whether a frame shows both. What different videos show has none in common.
[[nodiscard]] bool HasCommonFrame(const ObservedTracklet& a, const ObservedTracklet& b, Fits& fits);
[[nodiscard]] bool HasCommonFrame(const ObjectHypothesis& a, const ObjectHypothesis& b, Fits& fits);

/// The time of the first and of the last sighting, s of the video.
[[nodiscard]] double FirstTime(const ObjectHypothesis& hypothesis);
[[nodiscard]] double LastTime(const ObjectHypothesis& hypothesis);

/// The place of a hypothesis of one flight with all errors of the flight, for the comparison with objects of other
/// flights, whose errors are independent. Taken from `fits` by the first call.
const ObjectPlace& AbsolutePlace(ObjectHypothesis& hypothesis, Fits& fits);

/// The estimate of a hypothesis of one flight, with its path. Taken from `fits` by the first call.
const ObjectPlace& WithPath(ObjectHypothesis& hypothesis, Fits& fits);

/// Merges the tracklets of one model that are of one video, nearest pair (Mahalanobis) first, until no pair passes the
/// gates (associate_objects.h). Cost: two fits a tracklet and one a merge, and a distance for each pair of one video;
/// for two that are static and farther apart than `max_merge_distance_m`, some nanoseconds.
/// @param tracklets    by id; must outlive the result
/// @param constraints  those between which a cannot-link stands are not merged
/// @return by id
[[nodiscard]] std::vector<ObjectHypothesis> MergeTracklets(const std::vector<const ObservedTracklet*>& tracklets,
                                                           const LinkConstraints& constraints, Fits& fits);

}  // namespace victorious

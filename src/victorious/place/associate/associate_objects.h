// Data association: tracklets -> objects. An object has one identity over all its tracklets, one place, and a reason if
// it is rejected.
//
//   tracklets -> their places -> agglomerative merging within each flight, per model, nearest pair first
//             -> offsets between flights -> agglomerative merging across flights
//             -> rejection of wrong places -> rejection of false alarms
//
// A place is rejected if its lines of sight do not intersect, or if its height or the object's size contradicts it: by
// wrong telemetry, or because the object moves otherwise than modelled. The object is then one without a place. All
// objects of its flight say how likely the telemetry is wrong (flight_evidence.h): where they confirm it, a weak find
// is rejected with its place.
//
// Two tracklets that share a frame are two objects. Two others of one flight are merged if
// - the Mahalanobis distance of their places, both propagated to the time midway between them, passes
//   `merge_gate_sigma`,
// - their distance is at most `max_merge_distance_m`, and
// - a fraction `min_inlier_fraction` of all their lines of sight are inliers of the common place.
//
// Objects of different flights are merged by the same two gates. Their distance is measured after the offset of the two
// flights, if that is known (flight_registration.h), and one that moves is compared by UTC, with none without it
// (flight_fusion.h).
//
// What people say of the identity of tracklets (link_constraints.h) is obeyed: those between which a cannot-link stands
// are never merged, and those of a must-link are joined in the end, whatever their places are. The joined object has
// the place of one of its parts (linked_objects.h): an object that drove away was at both.
//
// The input is what the store holds (update_objects.h). The result is therefore independent of how often indexing was
// interrupted.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "victorious/place/associate/fits.h"
#include "victorious/place/associate/link_constraints.h"
#include "victorious/place/associate/object_options.h"
#include "victorious/place/associate/object_rejection.h"
#include "victorious/place/associate/observed_tracklet.h"
#include "victorious/place/associate/search_counts.h"
#include "victorious/types/index_records.h"

namespace victorious {

/// Associates tracklets to objects. Deterministic and independent of the order of `tracklets`. Returns the objects by
/// id; sets id, model, tracklets, place, heading, the reasons of rejection, and the score with what speaks against it.
/// @param searches  in each of their videos: the more tests of the a contrario decision, the more significant an
///                  object must be
std::vector<ObjectRecord> AssociateTracklets(std::vector<ObservedTracklet> tracklets, const SearchCounts& searches,
                                             const ObjectOptions& options, const LinkConstraints& constraints = {});

/// The same with given fits.
/// @param tracklets  by id, with their summaries; content only as far as `fits` needs it
/// @param overlaps   of all tracklets
std::vector<ObjectRecord> AssociateTracklets(std::span<const ObservedTracklet* const> tracklets,
                                             std::span<const TrackletOverlap> overlaps, const SearchCounts& searches,
                                             const LinkConstraints& constraints, Fits& fits);

}  // namespace victorious

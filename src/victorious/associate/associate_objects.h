// Data association: tracklets -> objects. An object has one identity over all its tracklets, one place, and a reason if
// it is rejected.
//
//   tracklets -> their places -> agglomerative merging, per model, nearest pair first -> rejection of wrong places
//             -> rejection of false alarms
//
// A place is rejected if its lines of sight do not intersect, or if its height or the object's size contradicts it: by
// wrong telemetry, or because the object moves otherwise than modelled. The object is then one without a place.
//
// Two tracklets that share a frame are two objects. Two others are merged if
// - the Mahalanobis distance of their places, both propagated to the time midway between them, passes
//   `merge_gate_sigma`,
// - their distance is at most `max_merge_distance_m`, and
// - a fraction `min_inlier_fraction` of all their lines of sight are inliers of the common place.
//
// The input is what the store holds. The result is therefore independent of how often indexing was interrupted, and is
// recomputed when another video adds tracklets.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "victorious/associate/object_options.h"
#include "victorious/associate/observed_tracklet.h"
#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/store/index_store.h"

namespace victorious {

class FlightErrorCache;

/// Associates tracklets to objects. Deterministic and independent of the order of `tracklets`. Returns the objects by
/// id; sets id, model, tracklets, place, heading and the reasons of rejection.
/// @param frames_searched  number of full-frame searches, summed over videos and models: the number of tests of the a
///                         contrario decision. The more tests, the more significant an object must be
std::vector<ObjectRecord> AssociateTracklets(std::vector<ObservedTracklet> tracklets, std::int64_t frames_searched,
                                             const ObjectOptions& options);

/// Recomputes the objects of the whole index and stores them; corrects the yaw and the ranges of each flight by the
/// errors on which its objects agree, which `cache` remembers (flight_errors.h).
/// @param cancel  as of IndexStore::UpdateObjects
/// @param warn    receives each line of Describe(), with its video
/// Errors: those of IndexStore; kDataLoss for a search whose stored options cannot be read.
[[nodiscard]] Status UpdateObjects(const ObjectOptions& options, IndexStore& store, FlightErrorCache& cache,
                                   const CancelToken& cancel,
                                   const std::function<void(const VideoRecord&, const std::string&)>& warn);

}  // namespace victorious

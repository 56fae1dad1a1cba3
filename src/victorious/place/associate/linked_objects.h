// Private to associate/: the objects that must be one (link_constraints.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <set>
#include <vector>

#include "victorious/place/associate/link_constraints.h"
#include "victorious/place/associate/object_hypothesis.h"
#include "victorious/types/index_records.h"

namespace victorious {

/// The videos that show it.
[[nodiscard]] std::set<std::int64_t> VideosOf(const ObjectHypothesis& hypothesis);

/// The distance of two places that do not agree, m; 0 if they do, or one has none.
[[nodiscard]] double DistanceApart_m(const ObjectRecord& object, const ObjectRecord& other,
                                     const ObjectOptions& options);

/// Which of two objects that are joined gives the joined one its place: true for `object`. In this order: one that is
/// not rejected; one that has a place; if the places agree, or their videos have no common time, the one with the
/// smaller error; the one that was seen later, since the object was elsewhere before.
[[nodiscard]] bool IsPreferred(const ObjectRecord& object, const ObjectHypothesis& hypothesis,
                               const ObjectRecord& other, const ObjectHypothesis& of_other,
                               const ObjectOptions& options);

/// Adds cannot-links between each group and the tracklets that share a frame with one of it: merged with another one of
/// the group, they would keep it apart.
/// @param of_one_model  by id
void SeparateFromGroups(const std::vector<const ObservedTracklet*>& of_one_model, Fits& fits,
                        LinkConstraints& constraints);

/// Calls `join` for each two hypotheses with tracklets of one group: the second becomes part of the first, which has
/// the smaller position, and is not named again. Not for those that share a frame, or between which a cannot-link
/// stands: a new search of a video may have found what people could not know.
/// @param hypotheses  `join` changes the first one
void JoinLinked(const LinkConstraints& constraints, std::vector<ObjectHypothesis>& hypotheses, Fits& fits,
                const std::function<void(std::size_t into, std::size_t from)>& join);

}  // namespace victorious

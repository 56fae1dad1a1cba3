// Which sightings of an object stand for it on a contact sheet.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace victorious {

/// How good a sighting is: its matches, then its score.
using MomentRank = std::pair<int, double>;

/// Chooses one of each of `count` equal parts of the sightings, the best of all first: the best one at least half a
/// part away from those chosen of other parts, or the best one if all are nearer. Distances are numbers of sightings.
/// @param ranks  of the sightings in order of time, not empty
/// @param count  at least 1
/// Returns indices into `ranks`, ascending; fewer than `count` if there are fewer sightings.
[[nodiscard]] std::vector<std::size_t> ChooseMoments(std::span<const MomentRank> ranks, std::size_t count);

}  // namespace victorious

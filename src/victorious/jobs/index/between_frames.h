// Frames between those that are tracked. At high frame rates objects are tracked in some of the frames only
// (SearchIntervals::tracked); in those between, what lies between two sightings of a track is stored.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "victorious/geometry/similarity.h"
#include "victorious/types/index_records.h"

namespace victorious {

/// A part of a motion: of its scale, rotation and translation. @param part  0: none of it; 1: all of it
[[nodiscard]] Similarity2 PartOfMotion(const Similarity2& motion, double part);

/// The sightings of a frame between two others: of each track that both show, with a box between theirs, the outline of
/// the nearer one, the lower score, and no bearing of its own.
/// @param before, after  sightings of the two frames
/// @param time_s         between their times
[[nodiscard]] std::vector<SightingRecord> SightingsBetween(std::span<const SightingRecord> before,
                                                           std::span<const SightingRecord> after, std::int64_t frame,
                                                           double time_s);

}  // namespace victorious

// What growth (track_growth.h) adds to the results of a pass over a video, as its last batch.
#pragma once

#include <cstdint>
#include <span>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/jobs/index/index_pass.h"
#include "victorious/store/index_store.h"

namespace victorious {

/// True if the pass lets its finds grow: it tracks, keeps no pace, has a model of photos, and its video can be read
/// again.
[[nodiscard]] bool MayGrow(const IndexPass& pass, bool is_live);

/// Adds the sightings and joined tracklets of the pass's models of photos to an empty batch. Everything that the pass
/// found before is in the store.
/// @param times_s  of all frames, from the first
/// @param end      the frame after the last one that was searched
/// Errors: those of the store, of GrowTracks and of reading the video; kCancelled.
[[nodiscard]] Status GrowResults(const IndexPass& pass, std::span<const double> times_s, std::int64_t end,
                                 const CancelToken& cancel, IndexStore& store, IndexBatch& batch);

}  // namespace victorious

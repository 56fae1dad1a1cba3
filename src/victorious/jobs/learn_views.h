// Makes a model of photos from what an index knows of an object: a view of it from each side from which it was seen.
// The model then finds it in other videos, from all these sides (ADR 0040).
//
// The object's sightings are looked at in order, twice a second. Where the views so far are not recognised, or with
// less than half of the matches that they had at best, the frame becomes a view, up to 60 of a model: the object within
// its outline, without what is around it. So the number of views depends on how much the object's look changes, not on
// time.
#pragma once

#include <cstddef>
#include <cstdint>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/store/index_store.h"
#include "victorious/types/object_model.h"

namespace victorious {

struct LearntViews {
  ObjectModel model;
  std::size_t learnt = 0;     ///< the last views of the model
  std::size_t looked_at = 0;  ///< sightings
};

/// Deterministic. Sightings of a score below 0.5, at the frame's border, or of less than 16 px are not looked at,
/// nor are rejected objects.
/// Shows progress on stderr.
/// @param known   a model of photos, which may have no views yet; its views come first
/// @param object  id in the index
/// Errors: those of the store and of OpenStoredVideo; kInvalidArgument for a CAD model; kCancelled.
[[nodiscard]] Expected<LearntViews> LearnViews(const ObjectModel& known, std::int64_t object, IndexStore& store,
                                               const CancelToken& cancel);

}  // namespace victorious

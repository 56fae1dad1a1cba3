// A person corrects which tracklets are one object: that is kept (IndexStore::PutTrackletGroups), and the objects of
// the index are made anew, as a search makes them in the end.
#pragma once

#include <cstdint>
#include <vector>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/base/warning_sink.h"
#include "victorious/store/index_store.h"
#include "victorious/types/tracklet_link.h"

namespace victorious {

struct RegroupedObjects {
  std::vector<std::int64_t> objects;  ///< of each group, in their order
  std::int64_t correction = 0;        ///< by which it is taken back
};

/// The parameters are those of the search that made the objects last.
/// @param cancel  stops the making of the objects; the correction is kept, and the next search obeys it
/// Errors: kInvalidArgument for fewer than two tracklets, an empty group, a tracklet that is named twice, tracklets of
/// different models or of what was boxed, and for what cannot be one object since it shares a frame: then nothing is
/// kept; kNotFound for a tracklet that is not in the index; those of ReadAssociation and of UpdateObjects.
[[nodiscard]] Expected<RegroupedObjects> RegroupObjects(const TrackletGroups& groups, IndexStore& store,
                                                        const CancelToken& cancel, const WarningSink& warn);

/// Takes a correction back. Returns the objects that the first tracklet of each group has then.
/// @param groups  their author and time are those of taking it back
/// Errors: kNotFound for a correction or a tracklet that is not there any more; those of ReadAssociation and of
/// UpdateObjects.
[[nodiscard]] Expected<std::vector<std::int64_t>> UndoRegrouping(std::int64_t correction, const TrackletGroups& groups,
                                                                 IndexStore& store, const CancelToken& cancel,
                                                                 const WarningSink& warn);

}  // namespace victorious

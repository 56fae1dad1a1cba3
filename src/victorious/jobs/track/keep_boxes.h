// Enters what a user boxed and had followed (track_job.h) into an index, as objects that are listed, reviewed, placed
// and exported as those that a search found.
//
// A box belongs to the category "boxed/TYPE" of its type, without one to "boxed/object". Nothing searches for these
// categories, and no model has such a name. Data association leaves them as they are: what the tracker found of a box,
// in all of its videos, is one object, at the place that the job gave it.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/jobs/track/box_sighting.h"
#include "victorious/store/index_store.h"

namespace victorious {

/// The name of a box's category.
[[nodiscard]] std::string CategoryOfBox(const UserBox& box);

/// The records of videos in an index, in their order; reads each file once.
/// Errors: kNotFound for a video that the index does not have; those of VideoReader and of the store.
[[nodiscard]] Expected<std::vector<VideoRecord>> FindTrackedVideos(std::span<const std::string> videos,
                                                                   IndexStore& store, const CancelToken& cancel);

/// Enters the sightings, each box with one tracklet in each video that shows it, in a transaction each. A box whose
/// track in a video is there already, by this box or by another one, adds nothing there: done twice, or again after it
/// was stopped, it is as done once.
/// @param sightings  by video and frame; of each box, one or more
/// @param videos     of FindTrackedVideos
/// @return the object of each box
/// Errors: kInvalidArgument for a category whose name is that of a model, or of a category that is searched for; those
/// of the store.
[[nodiscard]] Expected<std::vector<std::int64_t>> KeepBoxes(std::span<const BoxSighting> sightings,
                                                            std::span<const UserBox> boxes,
                                                            std::span<const VideoRecord> videos, IndexStore& store);

}  // namespace victorious

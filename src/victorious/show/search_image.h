// Search by example image in videos that are indexed already. Decodes no video: matches the example against the kept
// features, those of one frame per `keep.interval_s` (docs/formats/index.md).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/geometry/box.h"
#include "victorious/object/model/photo_model.h"
#include "victorious/search/recognize/recognizer.h"
#include "victorious/store/index_store.h"

namespace victorious {

/// An interval of one video in which consecutive kept frames show the object, or with gaps of at most 2.5 s; described
/// by its best frame.
struct VideoSegment {
  std::string video;
  std::int64_t frame = 0;
  double time_s = 0;
  Box box;
  double score = 0;
  int matches = 0;
  double first_time_s = 0;
  double last_time_s = 0;
  int frames = 0;  ///< number of kept frames with the object
};

struct ImageSearch {
  std::vector<VideoSegment> segments;  ///< best score first
  std::int64_t searched_frames = 0;    ///< number of kept frames that were searched
  std::int64_t searched_videos = 0;    ///< number of videos that they are of
};

/// Searches the kept frames for the object of an example image.
/// @param example  image of the object
/// Errors: those of the store; kInvalidArgument if no features are kept, or the example has too few.
[[nodiscard]] Expected<ImageSearch> SearchByImage(const Photo& example, const SightingFilter& filter,
                                                  const RecognizeOptions& options, IndexStore& store);

}  // namespace victorious

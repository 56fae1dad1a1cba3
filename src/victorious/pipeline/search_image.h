// Search by picture: an example of an object as the query over videos that are indexed already. Nothing is decoded: the
// features kept of one frame in so many seconds (docs/formats/index.md) are searched as a scene's.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/geometry/box.h"
#include "victorious/model/photo_model.h"
#include "victorious/recognize/recognizer.h"
#include "victorious/store/index_store.h"

namespace victorious {

/// A stretch of one video in which the object is seen in one kept frame after the other, or never missed for longer
/// than 2.5 s; told by its best frame.
struct Moment {
  std::string video;
  std::int64_t frame = 0;
  double time_s = 0;
  Box box;
  double score = 0;
  int matches = 0;
  double first_time_s = 0;
  double last_time_s = 0;
  int frames = 0;  ///< kept frames with the object
};

/// @param example  the object's picture
/// @return best first
/// Errors: those of the store; kInvalidArgument if no features were kept, or the example has too few.
Expected<std::vector<Moment>> SearchByImage(const Photo& example, const SightingFilter& filter,
                                            const RecognizeOptions& options, IndexStore& store);

}  // namespace victorious

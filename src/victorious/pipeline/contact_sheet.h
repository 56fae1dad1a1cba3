// Contact sheet of an index: one tile per object, with the outline of its best sighting drawn onto the video frame.
#pragma once

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"
#include "victorious/base/options.h"
#include "victorious/store/index_store.h"

namespace victorious {

struct ContactSheetOptions {
  int max_tiles = 24;
  int columns = 4;
  int tile_width_px = 320;

  void ListFields(FieldList& fields);
};

/// Returns a CV_8UC3 image with the tiles in rows, best objects first.
/// Errors: kInvalidArgument if no object passes the filter; those of reading the videos, which must still be at their
/// paths.
[[nodiscard]] Expected<cv::Mat> DrawContactSheet(const SightingFilter& filter, const ContactSheetOptions& options,
                                                 IndexStore& store);

}  // namespace victorious

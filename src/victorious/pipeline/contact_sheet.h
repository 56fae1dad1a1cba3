// The finds as pictures: one tile an object, its best sighting drawn onto the frame it is in.
#pragma once

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"
#include "victorious/base/options.h"
#include "victorious/store/index_store.h"

namespace victorious {

struct ContactSheetOptions {
  int most_tiles = 24;
  int columns = 4;
  int tile_width_px = 320;

  void ListFields(FieldList& fields);
};

/// @return CV_8UC3, best objects first, in rows
/// Errors: kInvalidArgument if there is no object to show; those of reading the videos, which must be where they were.
Expected<cv::Mat> DrawContactSheet(const SightingFilter& filter, const ContactSheetOptions& options, IndexStore& store);

}  // namespace victorious

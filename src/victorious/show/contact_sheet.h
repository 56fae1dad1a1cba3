// Contact sheet of an index, to judge objects by eye: one tile per object, with the outline of its best sighting drawn
// onto the video frame, and below it the object alone, cut out of the frames of several moments.
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
  int moments = 3;  ///< number of cut-outs per tile

  void ListFields(FieldList& fields);
};

/// Returns a CV_8UC3 image with the tiles in rows, best objects first. The moments of an object are spread over its
/// sightings: of each part one with many matches, away from those of the other parts. A cut-out is square, fills its
/// place in the tile with the object and a quarter of its size around it, and is enlarged at most 4 times.
/// Errors: kInvalidArgument if no object passes the filter; those of reading the videos, which must still be at their
/// paths.
[[nodiscard]] Expected<cv::Mat> DrawContactSheet(const SightingFilter& filter, const ContactSheetOptions& options,
                                                 IndexStore& store);

}  // namespace victorious

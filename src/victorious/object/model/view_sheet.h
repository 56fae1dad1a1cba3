// Draws a contact sheet of a model's views for visual inspection: object, view angles, number of features.
#pragma once

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"
#include "victorious/types/object_model.h"

namespace victorious {

/// One tile per view: thumbnail, azimuth in degrees if known, number of features, and a bar whose length is that number
/// relative to the maximum. Views with angles are sorted by off-nadir angle (one row per ring, wrapped after 36 views),
/// then by azimuth. Views without angles follow in their order.
/// @return CV_8UC3
/// Errors: kInvalidArgument, the model has no thumbnails, or more than 2000 views, or the sheet is too large;
/// kDataLoss, a damaged thumbnail, or one larger than 256 pixels a side.
[[nodiscard]] Expected<cv::Mat> DrawViewSheet(const ObjectModel& model);

}  // namespace victorious

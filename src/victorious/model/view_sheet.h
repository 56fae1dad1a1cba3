// A model's views as one picture, for people: is this the object, seen from where it should be, and with features?
#pragma once

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"
#include "victorious/types/object_model.h"

namespace victorious {

/// One tile a view: its thumbnail, its azimuth in degrees where it has one, the number of its features and a bar as
/// long as that number is beside the largest. Views with angles stand ring by ring, straight above first, by azimuth;
/// a ring of more than 36 goes on below. Those without angles follow in their order.
/// @return CV_8UC3
/// Errors: kInvalidArgument, a model whose file holds no thumbnails, or more views than can be drawn (2000); kDataLoss,
/// a damaged thumbnail, or one larger than 256 pixels a side.
Expected<cv::Mat> DrawViewSheet(const ObjectModel& model);

}  // namespace victorious

// The part of a frame that shows an object, for lists.
#pragma once

#include <opencv2/core/mat.hpp>

#include "victorious/geometry/box.h"

namespace victorious {

/// The region of a frame that a crop shows: the box with a margin, at least 48 px, of the aspect 4:3, moved into the
/// frame; a box larger than the frame gives a region that extends beyond it.
[[nodiscard]] Box CropRegion(const Box& box, int frame_width_px, int frame_height_px);

/// The region, scaled to a width; dark where it extends beyond the frame.
[[nodiscard]] cv::Mat CutOut(const cv::Mat& frame, const Box& region, int width_px);

}  // namespace victorious

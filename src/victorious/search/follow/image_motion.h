// How far an image has moved, by which it is decided what is seen anew.
#pragma once

#include <opencv2/core/types.hpp>

#include "victorious/geometry/similarity.h"

namespace victorious {

/// The farthest that a corner of the frame, or its centre, moves, as a fraction of the diagonal. @param motion  px
[[nodiscard]] double FractionMoved(const Similarity2& motion, const cv::Size& size);

}  // namespace victorious

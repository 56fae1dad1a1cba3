// Private to recognize/, for ShapeSearch: a match by contours found again in a later frame, near where it is expected.
#pragma once

#include <optional>

#include <opencv2/core/mat.hpp>

#include "victorious/search/recognize/contour_search.h"

namespace victorious {

/// As FindByContours, from a pose that is known to some per cent, in the image's pixels. Cost: a tenth of that.
/// @param grey  CV_8UC1, without impulse noise
[[nodiscard]] std::optional<ContourMatch> FindContoursNear(const ContourModel& model, const cv::Mat& grey,
                                                           ContourPose start);

/// The focal length that is assumed for an image, px.
[[nodiscard]] double AssumedFocalPx(const cv::Size& size);

}  // namespace victorious

// Salt-and-pepper noise out of an image before keypoints are sought in it: each impulse is a corner to a detector, and
// spoils every descriptor that covers it.
#pragma once

#include <opencv2/core/mat.hpp>

namespace victorious {

/// A pixel is an impulse if it stands out from the median of the 3 x 3 about it, or by twice as much from that of the
/// 5 x 5; impulses become the mean of the nearest pixels that are none, weighted by 1 / distance^2. Every other pixel
/// stays as it is, unlike under a median filter.
/// @param grey         CV_8UC1
/// @param least_share  an image is clean, and returned as it is, that has a smaller share of impulses in its flat
///                     places: whether there are any is asked there, where no lines, leaves and print stand out
/// Cost: some 3 ms for 640 x 480 pixels.
cv::Mat WithoutImpulses(const cv::Mat& grey, double least_share);

}  // namespace victorious

// Tracks what a detector found to the frames that it does not search. A box moves with the median of the motion of
// points on a grid in it, and grows with the median of the ratios of their distances; a point counts that Lucas-Kanade
// tracks forward and back. What the detector finds next replaces all boxes.
// Source: Z. Kalal, K. Mikolajczyk, J. Matas, "Forward-backward error: automatic detection of tracking failures", ICPR
// 2010 (Median Flow).
#pragma once

#include <optional>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/category/finder/category_source.h"
#include "victorious/geometry/similarity.h"
#include "victorious/track/flow.h"

namespace victorious {

/// Call for consecutive frames, in order. Not thread-safe.
class CategoryFollower {
 public:
  /// A frame that was searched.
  void Restart(const cv::Mat& grey, std::vector<FoundCategory> found);

  /// A frame that was not. @param now_from_before  motion of the image from the frame before
  /// @return the boxes that could be tracked, inside the frame, as tracked
  [[nodiscard]] std::vector<FoundCategory> Follow(const cv::Mat& grey,
                                                  const std::optional<Similarity2>& now_from_before);

 private:
  std::optional<FlowPyramid> before_;  ///< std::nullopt: nothing is tracked
  std::vector<FoundCategory> boxes_;
};

}  // namespace victorious

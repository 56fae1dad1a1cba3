// Is an object that stands somewhere in a frame seen as in one of the known views? What growth (index/track_growth.h)
// and `model grow` (learn_views.h) share.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"
#include "victorious/geometry/box.h"
#include "victorious/search/follow/region_features.h"
#include "victorious/search/recognize/recognizer.h"

namespace victorious {

inline constexpr double kMinViewOverlap = 0.3;      ///< IoU of boxes that are one object's
inline constexpr double kWeakMatches = 0.5;         ///< of the most that a view had: it is at the end of its reach
inline constexpr std::size_t kMinViewFeatures = 8;  ///< of a learnt view
inline constexpr std::size_t kMaxLearntViews = 60;  ///< of an object

/// The features of an object and of what is right beside it, in the frame's pixels. @param grey  CV_8UC1
[[nodiscard]] inline Expected<FeatureSet> FeaturesAround(const cv::Mat& grey, const Box& box,
                                                         const FeatureExtractor& extractor) {
  constexpr double kMargin = 0.35;  // of the sides
  return FeaturesIn(grey,
                    {box.x - kMargin * box.width, box.y - kMargin * box.height, (1 + 2 * kMargin) * box.width,
                     (1 + 2 * kMargin) * box.height},
                    extractor);
}

/// The best detection whose box agrees with `box`; null: there is none. @param detections  best first
[[nodiscard]] inline const Detection* DetectionAt(std::span<const Detection> detections, const Box& box) {
  const auto found = std::ranges::find_if(
      detections, [&](const Detection& one) { return IntersectionOverUnion(one.box, box) >= kMinViewOverlap; });
  return found == detections.end() ? nullptr : &*found;
}

/// True for the box of an object that leaves the frame. @param frame  FrameBox()
[[nodiscard]] inline bool IsAtBorder(const Box& box, const Box& frame) {
  constexpr double kBorder_px = 2;
  const Box inner{frame.x + kBorder_px, frame.y + kBorder_px, frame.width - 2 * kBorder_px,
                  frame.height - 2 * kBorder_px};
  return Intersection(box, inner) != box;
}

}  // namespace victorious

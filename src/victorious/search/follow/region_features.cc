#include "victorious/search/follow/region_features.h"

#include <cmath>

namespace victorious {

Expected<FeatureSet> FeaturesIn(const cv::Mat& grey, const Box& region, const FeatureExtractor& extractor) {
  const cv::Rect whole({0, 0}, grey.size());
  const cv::Rect cut =
      whole & cv::Rect(static_cast<int>(region.x), static_cast<int>(region.y),
                       static_cast<int>(std::ceil(region.width)) + 1, static_cast<int>(std::ceil(region.height)) + 1);
  FeatureSet features;
  if (!cut.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(features, extractor.Extract(grey(cut)));
  }
  for (Keypoint& keypoint : features.keypoints) {
    keypoint.x += static_cast<float>(cut.x);
    keypoint.y += static_cast<float>(cut.y);
  }
  features.image_width = whole.width;
  features.image_height = whole.height;
  features.part = {static_cast<double>(cut.x), static_cast<double>(cut.y), static_cast<double>(cut.width),
                   static_cast<double>(cut.height)};
  return features;
}

}  // namespace victorious

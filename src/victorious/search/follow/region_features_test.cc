#include "victorious/search/follow/region_features.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace victorious {
namespace {

// A bright disc on dark background.
cv::Mat Disc(cv::Point middle) {
  cv::Mat grey(200, 300, CV_8UC1, cv::Scalar(30));
  cv::circle(grey, middle, 6, cv::Scalar(220), cv::FILLED, cv::LINE_AA);
  return grey;
}

TEST(FeaturesIn, KeypointsAreInFramePixels) {
  const auto extractor = MakeFeatureExtractor({}).value();
  const FeatureSet features = FeaturesIn(Disc({210, 120}), {170, 80, 90, 90}, *extractor).value();
  EXPECT_EQ(features.image_width, 300);
  EXPECT_EQ(features.image_height, 200);
  EXPECT_EQ(features.SearchedBox(), (Box{170, 80, 91, 91})) << "wrong matches lie nowhere else";
  ASSERT_FALSE(features.keypoints.empty());
  for (const Keypoint& keypoint : features.keypoints) {
    EXPECT_NEAR(keypoint.x, 210.5, 8);
    EXPECT_NEAR(keypoint.y, 120.5, 8);
  }
}

TEST(FeaturesIn, RegionOutsideTheFrameHasNone) {
  const auto extractor = MakeFeatureExtractor({}).value();
  const FeatureSet features = FeaturesIn(Disc({210, 120}), {400, 300, 50, 50}, *extractor).value();
  EXPECT_TRUE(features.keypoints.empty());
  EXPECT_EQ(features.image_width, 300);
}

}  // namespace
}  // namespace victorious

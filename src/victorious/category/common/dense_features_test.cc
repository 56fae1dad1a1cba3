#include "victorious/category/common/dense_features.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "testing/category_tools.h"

namespace victorious {
namespace {

TEST(DenseFeatures, FormAGridInsideTheImage) {
  Random random(1);
  cv::Mat image(120, 160, CV_8UC1);
  for (auto& pixel : cv::Mat_<std::uint8_t>(image)) pixel = static_cast<std::uint8_t>(random.Below(256));
  const FeatureSet features = DenseFeatures(image, {.step_px = 10, .sizes = 1});
  // 160 x 120 px minus a margin of 8 px on each side, step 10 px.
  EXPECT_EQ(features.size(), 15U * 11U);
  EXPECT_EQ(features.descriptors.size(), features.size() * kDescriptorSize);
  EXPECT_FLOAT_EQ(features.keypoints[0].x, 8);
  EXPECT_FLOAT_EQ(features.keypoints[0].y, 8);
  EXPECT_FLOAT_EQ(features.keypoints[0].scale_px, 4.0F / 3);
  EXPECT_EQ(features.keypoints[0].orientation_rad, 0);
  EXPECT_EQ(features.keypoints[1].x, 18);
}

TEST(DenseFeatures, UniformImageHasNone) {
  EXPECT_EQ(DenseFeatures(cv::Mat(120, 160, CV_8UC1, cv::Scalar(90)), DenseOptions()).size(), 0U);
  EXPECT_EQ(DenseFeatures(cv::Mat(), DenseOptions()).size(), 0U);
  EXPECT_EQ(DenseFeatures(cv::Mat(1, 3, CV_8UC1, cv::Scalar(90)), DenseOptions()).size(), 0U);
}

TEST(DenseFeatures, EdgeHasGradientOrientation) {
  // Dark above bright: the gradient points down, +90 degrees, the third of eight orientations.
  cv::Mat image(64, 64, CV_8UC1, cv::Scalar(40));
  image.rowRange(32, 64).setTo(200);
  const FeatureSet features = DenseFeatures(image, {.step_px = 48, .sizes = 3});
  ASSERT_GT(features.size(), 0U);
  // At the largest scale the first patch reaches across the edge.
  const auto descriptor = features.View().Descriptor(features.size() - 1);
  const auto largest = std::ranges::max_element(descriptor) - descriptor.begin();
  EXPECT_EQ(largest % 8, 2);
}

TEST(DenseFeatures, LargeImageEqualsReducedImage) {
  Random random(2);
  const cv::Mat small = testing::DrawPair(true, random);
  cv::Mat large;
  cv::resize(small, large, {}, 4, 4, cv::INTER_NEAREST);
  const DenseOptions options = {.max_side_px = 160};
  const FeatureSet a = DenseFeatures(small, options);
  const FeatureSet b = DenseFeatures(large, options);
  ASSERT_EQ(a.size(), b.size());
  EXPECT_EQ(a.descriptors, b.descriptors);
  EXPECT_FLOAT_EQ(b.keypoints[5].x, 4 * a.keypoints[5].x);
  EXPECT_FLOAT_EQ(b.keypoints[5].scale_px, 4 * a.keypoints[5].scale_px);
}

}  // namespace
}  // namespace victorious

#include "victorious/object/features/feature_extractor.h"

#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

// A bright Gaussian blob: one keypoint at its centre, with a scale proportional to its sigma.
cv::Mat Blob(int side, double x, double y, double sigma) {
  cv::Mat image(side, side, CV_8UC1);
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      const double dx = column + 0.5 - x;
      const double dy = row + 0.5 - y;
      image.at<std::uint8_t>(row, column) =
          cv::saturate_cast<std::uint8_t>(40 + 180 * std::exp(-(dx * dx + dy * dy) / (2 * sigma * sigma)));
    }
  }
  return image;
}

cv::Mat Clutter(int width, int height, std::uint64_t seed) {
  Random random(seed);
  cv::Mat image(height, width, CV_8UC1, cv::Scalar(128));
  for (int i = 0; i < 120; ++i) {
    const cv::Point corner(static_cast<int>(random.Below(static_cast<std::uint32_t>(width))),
                           static_cast<int>(random.Below(static_cast<std::uint32_t>(height))));
    const cv::Size size(4 + static_cast<int>(random.Below(40)), 4 + static_cast<int>(random.Below(40)));
    cv::rectangle(image, cv::Rect(corner, size), cv::Scalar(random.Below(256)), cv::FILLED);
  }
  cv::GaussianBlur(image, image, cv::Size(), 0.8);
  return image;
}

// Runs for every engine.
class EveryEngine : public ::testing::TestWithParam<std::string> {
 protected:
  static std::unique_ptr<const FeatureExtractor> Extractor(FeatureOptions options = {}) {
    options.engine = GetParam();
    return MakeFeatureExtractor(options).value();
  }
};

TEST_P(EveryEngine, LocatesBlobAtItsCentre) {
  for (const double offset : {0.0, 0.25, 0.5, 0.8}) {
    for (const double sigma : {2.5, 4.0, 8.0}) {
      const double x = 64 + offset;
      const double y = 60 - offset;
      const FeatureSet features = Extractor()->Extract(Blob(128, x, y, sigma)).value();
      double nearest = 1e9;
      for (const Keypoint& keypoint : features.keypoints)
        nearest = std::min(nearest, std::hypot(keypoint.x - x, keypoint.y - y));
      EXPECT_LT(nearest, 0.12) << "offset " << offset << " sigma " << sigma;
    }
  }
}

TEST_P(EveryEngine, ScaleIsProportionalToBlobSize) {
  for (const double sigma : {3.0, 6.0, 9.0}) {
    const FeatureSet features = Extractor()->Extract(Blob(160, 80, 80, sigma)).value();
    ASSERT_GT(features.size(), 0U);
    // A Gaussian's difference-of-Gaussians response peaks near the blob's own sigma, a little below.
    EXPECT_NEAR(features.keypoints.front().scale_px / sigma, 0.95, 0.15);
  }
}

TEST_P(EveryEngine, OrientationRotatesWithTheImage) {
  const cv::Mat image = Clutter(200, 200, 3);
  cv::Mat turned;  // clockwise on the screen: +x goes to +y
  cv::rotate(image, turned, cv::ROTATE_90_CLOCKWISE);
  const FeatureSet before = Extractor()->Extract(image).value();
  const FeatureSet after = Extractor()->Extract(turned).value();
  int agreeing = 0;
  int compared = 0;
  for (const Keypoint& a : before.keypoints) {
    for (const Keypoint& b : after.keypoints) {
      if (std::hypot(b.x - (200 - a.y), b.y - a.x) > 0.5 || std::abs(std::log(a.scale_px / b.scale_px)) > 0.05)
        continue;
      ++compared;
      if (std::abs(WrapAngle(b.orientation_rad - a.orientation_rad - kPi / 2)) < 0.1) ++agreeing;
    }
  }
  EXPECT_GT(compared, 50);
  EXPECT_GT(agreeing, compared * 2 / 3);  // the rest are keypoints of several orientations
}

TEST_P(EveryEngine, LargeImagesAreDownscaled) {
  FeatureOptions options;
  options.max_side_px = 128;
  const FeatureSet features = Extractor(options)->Extract(Blob(256, 150.5, 100.25, 12)).value();
  ASSERT_GT(features.size(), 0U);
  EXPECT_NEAR(features.keypoints.front().x, 150.5, 0.3);
  EXPECT_NEAR(features.keypoints.front().y, 100.25, 0.3);
  EXPECT_EQ(features.image_width, 256);
}

TEST_P(EveryEngine, TinyAndEmptyImagesHaveNoFeatures) {
  EXPECT_EQ(Extractor()->Extract(cv::Mat()).value().size(), 0U);
  for (int side = 1; side < 20; ++side) {
    EXPECT_TRUE(Extractor()->Extract(cv::Mat(side, side + 1, CV_8UC1, cv::Scalar(9))).has_value()) << side;
  }
}

TEST_P(EveryEngine, ImagesTooThinAfterDownscalingHaveNoFeatures) {
  for (const cv::Size size : {cv::Size(40000, 9), cv::Size(9, 40000), cv::Size(20000, 40), cv::Size(20000, 77)}) {
    const auto features = Extractor()->Extract(cv::Mat(size, CV_8UC1, cv::Scalar(9)));
    ASSERT_TRUE(features) << size << ": " << features.error().message;
    EXPECT_EQ(features->size(), 0U);
    EXPECT_EQ(features->image_width, size.width);
  }
}

TEST_P(EveryEngine, BoundsTheNumberOfKeypoints) {
  const cv::Mat image = Clutter(200, 200, 5);
  const std::size_t all = Extractor()->Extract(image).value().size();
  FeatureOptions options;
  options.max_features = static_cast<int>(all / 2);
  const FeatureSet strongest = Extractor(options)->Extract(image).value();
  EXPECT_NEAR(static_cast<double>(strongest.size()), static_cast<double>(all / 2), 3);  // ties may be kept
  EXPECT_EQ(strongest.descriptors.size(), strongest.size() * kDescriptorSize);
}

INSTANTIATE_TEST_SUITE_P(Engines, EveryEngine, ::testing::ValuesIn(FeatureEngines()),
                         [](const auto& test) { return test.param; });

TEST(FeatureExtractor, RefusesOptionsOutOfRange) {
  FeatureOptions options;
  options.engine = "magic";
  options.max_side_px = 0;
  const auto result = MakeFeatureExtractor(options);
  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().code, ErrorCode::kInvalidArgument);
  EXPECT_NE(result.error().message.find("engine = \"magic\""), std::string::npos) << result.error().message;
  EXPECT_NE(result.error().message.find("max_side_px = 0"), std::string::npos) << result.error().message;
}

}  // namespace
}  // namespace victorious

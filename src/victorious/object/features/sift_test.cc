#include "victorious/object/features/sift.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#include <opencv2/imgproc.hpp>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"
#include "victorious/kernels/target_test.h"

namespace victorious {
namespace {

// Discs and rectangles of many sizes, blurred a little, with noise.
cv::Mat SiftClutter(int width, int height, std::uint64_t seed) {
  Random random(seed);
  cv::Mat image(height, width, CV_8UC1, cv::Scalar(128));
  const auto below = [&](int bound) { return static_cast<int>(random.Below(static_cast<std::uint32_t>(bound))); };
  for (int i = 0; i < width * height / 300; ++i) {
    const cv::Point place(below(width), below(height));
    const cv::Scalar grey(below(256));
    if (i % 2 == 0) {
      cv::circle(image, place, 2 + below(12), grey, cv::FILLED);
    } else {
      cv::rectangle(image, cv::Rect(place, cv::Size(3 + below(30), 3 + below(30))), grey, cv::FILLED);
    }
  }
  cv::GaussianBlur(image, image, cv::Size(), 0.8);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      auto& pixel = image.at<std::uint8_t>(y, x);
      pixel = cv::saturate_cast<std::uint8_t>(pixel + 2 * random.Normal());
    }
  }
  return image;
}

std::unique_ptr<const FeatureExtractor> Extractor(const std::string& engine, int max_features = 0) {
  FeatureOptions options = LowContrastFeatureOptions();
  options.engine = engine;
  options.max_features = max_features;
  return MakeFeatureExtractor(options).value();
}

void ExpectSame(const FeatureSet& a, const FeatureSet& b) {
  EXPECT_EQ(a.keypoints, b.keypoints);
  EXPECT_EQ(a.descriptors, b.descriptors);
}

class SiftTarget : public kernels::TargetTest {};

// The reference: the least of the instruction sets, which Highway numbers last.
TEST_P(SiftTarget, GivesTheSameFeatures) {
  const cv::Mat image = SiftClutter(211, 173, 1);
  const FeatureSet features = Extractor("sift")->Extract(image).value();
  Choose(kernels::TestedTargets().back());
  const FeatureSet expected = Extractor("sift")->Extract(image).value();
  EXPECT_GT(features.size(), 300U);
  ExpectSame(features, expected);
}

VICTORIOUS_EVERY_TARGET(SiftTarget);

TEST(Sift, ThreadsDoNotChangeTheFeatures) {
  const cv::Mat image = SiftClutter(320, 400, 2);  // several bands
  const auto extractor = Extractor("sift");
  const oneapi::tbb::global_control allow(oneapi::tbb::global_control::max_allowed_parallelism, 8);
  std::optional<FeatureSet> alone;
  oneapi::tbb::task_arena(1).execute([&] { alone = extractor->Extract(image).value(); });
  for (const int threads : {2, 3, 8}) {
    oneapi::tbb::task_arena(threads).execute([&] { ExpectSame(extractor->Extract(image).value(), *alone); });
  }
}

TEST(Sift, ManyImagesAtATimeAndAgain) {
  std::vector<cv::Mat> images;
  std::vector<FeatureSet> expected;
  for (int i = 0; i < 6; ++i) {
    images.push_back(SiftClutter(60 + 45 * i, 250 - 35 * i, static_cast<std::uint64_t>(i)));
    expected.push_back(Extractor("sift")->Extract(images.back()).value());
  }
  const auto extractor = Extractor("sift");
  const auto few = Extractor("sift", 5);  // shares its memory
  const FeatureSet expected_few = few->Extract(images[2]).value();
  ASSERT_EQ(expected_few.size(), 5U);
  oneapi::tbb::parallel_for(0, 60, [&](int i) {
    const auto n = static_cast<std::size_t>(i % 6);
    ExpectSame(extractor->Extract(images[n]).value(), expected[n]);
    if (n == 2) ExpectSame(few->Extract(images[n]).value(), expected_few);
  });
}

TEST(Sift, AnyPartOfALargerImageIsAnImage) {  // rows that are not contiguous
  const cv::Mat image = SiftClutter(200, 150, 3);
  const cv::Mat part = image(cv::Rect(31, 17, 101, 93));
  const auto extractor = Extractor("sift");
  ExpectSame(extractor->Extract(part).value(), extractor->Extract(part.clone()).value());
}

TEST(Sift, EverySmallSize) {
  const auto extractor = Extractor("sift");
  const cv::Mat image = SiftClutter(400, 60, 4);
  for (int height = 1; height < 40; ++height) {
    for (const int width : {8, 9, 15, 16, 17, 31, 33, 40, 400}) {
      const FeatureSet features = extractor->Extract(image(cv::Rect(0, 0, width, height))).value();
      for (const Keypoint& keypoint : features.keypoints) {
        EXPECT_TRUE(keypoint.x > 0 && keypoint.x < static_cast<float>(width)) << keypoint.x;
        EXPECT_TRUE(keypoint.y > 0 && keypoint.y < static_cast<float>(height)) << keypoint.y;
      }
    }
  }
}

TEST(Sift, AConstantImageHasNone) {
  for (const int grey : {0, 100, 255}) {
    EXPECT_EQ(Extractor("sift")->Extract(cv::Mat(90, 120, CV_8UC1, cv::Scalar(grey))).value().size(), 0U);
  }
}

TEST(Sift, TheStrongestKeepTheirOrder) {
  const cv::Mat image = SiftClutter(200, 150, 5);
  const FeatureSet all = Extractor("sift")->Extract(image).value();
  const FeatureSet few = Extractor("sift", 100)->Extract(image).value();
  ASSERT_EQ(few.size(), 100U);
  std::size_t next = 0;
  for (std::size_t i = 0; i < few.size(); ++i, ++next) {
    while (next < all.size() && all.keypoints[next] != few.keypoints[i]) ++next;
    ASSERT_LT(next, all.size());
    EXPECT_TRUE(std::ranges::equal(all.View().Descriptor(next), few.View().Descriptor(i)));
  }
}

// OpenCV is the check: the same keypoints, with descriptors that match.
TEST(Sift, AgreesWithOpenCv) {
  const cv::Mat image = SiftClutter(320, 240, 6);
  const FeatureSet ours = Extractor("sift")->Extract(image).value();
  const FeatureSet theirs = Extractor("opencv")->Extract(image).value();
  EXPECT_NEAR(static_cast<double>(ours.size()), static_cast<double>(theirs.size()),
              0.08 * static_cast<double>(theirs.size()));
  std::size_t found = 0;
  double shift_x = 0;
  double shift_y = 0;
  double distance = 0;
  for (std::size_t i = 0; i < theirs.size(); ++i) {
    const Keypoint& their = theirs.keypoints[i];
    for (std::size_t j = 0; j < ours.size(); ++j) {
      const Keypoint& our = ours.keypoints[j];
      if (std::hypot(our.x - their.x, our.y - their.y) > 0.5 ||
          std::abs(std::log(our.scale_px / their.scale_px)) > 0.1 ||
          std::abs(WrapAngle(our.orientation_rad - their.orientation_rad)) > 0.1) {
        continue;
      }
      ++found;
      shift_x += our.x - their.x;
      shift_y += our.y - their.y;
      double squares = 0;
      for (std::size_t k = 0; k < kDescriptorSize; ++k) {
        const double d = ours.View().Descriptor(j)[k] - theirs.View().Descriptor(i)[k];
        squares += d * d;
      }
      distance += std::sqrt(squares);
      break;
    }
  }
  const auto count = static_cast<double>(found);
  EXPECT_GT(count, 0.85 * static_cast<double>(theirs.size()));
  EXPECT_NEAR(shift_x / count, 0, 0.01);
  EXPECT_NEAR(shift_y / count, 0, 0.01);
  EXPECT_LT(distance / count, 120);  // descriptors have the length 512; those of different places differ by about 500
}

}  // namespace
}  // namespace victorious

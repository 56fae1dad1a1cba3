#include "victorious/search/recognize/ncc_rescoring.h"

#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "testing/flat_view_source.h"
#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

constexpr int kSidePx = 90;

// Large light and dark regions without corners.
cv::Mat Patches(const cv::Size& size, double breadth_px, std::uint64_t seed) {
  Random random(seed);
  cv::Mat image(size, CV_32F);
  image.forEach<float>([](float& pixel, const int*) { pixel = 0; });
  for (int row = 0; row < size.height; ++row) {
    for (int column = 0; column < size.width; ++column) image.at<float>(row, column) = random.Uniform() < 0.5 ? 0 : 1;
  }
  cv::GaussianBlur(image, image, {}, breadth_px);
  cv::normalize(image, image, 40, 200, cv::NORM_MINMAX);
  cv::Mat grey;
  image.convertTo(grey, CV_8U);
  return grey;
}

testing::FlatViewSource RescoringSamplesOf(const cv::Mat& grey) { return {grey, 4, 5}; }

constexpr double kTurn_rad = 0.7;
const Eigen::Vector2d kMiddle(400, 200);

Similarity2 PoseAt(const Eigen::Vector2d& middle, double turn_rad) {
  Similarity2 fit{1, turn_rad, Eigen::Vector2d::Zero()};
  fit.translation = middle - fit.Linear() * Eigen::Vector2d(kSidePx / 2.0, kSidePx / 2.0);
  return fit;
}

// A background of light and dark regions with the object in it, at a given contrast.
cv::Mat SceneWith(const cv::Mat& object, double contrast) {
  cv::Mat scene = Patches({640, 480}, 6, 11);
  const Similarity2 fit = PoseAt(kMiddle, kTurn_rad);
  const Eigen::Matrix2d a = fit.Linear();
  const Eigen::Vector2d t = fit.translation + a * Eigen::Vector2d(0.5, 0.5) - Eigen::Vector2d(0.5, 0.5);
  const cv::Matx23d matrix(a(0, 0), a(0, 1), t.x(), a(1, 0), a(1, 1), t.y());
  cv::Mat painted;
  object.convertTo(painted, CV_8U, contrast, 128 * (1 - contrast));
  cv::warpAffine(painted, scene, matrix, scene.size(), cv::INTER_LINEAR, cv::BORDER_TRANSPARENT);
  return scene;
}

std::optional<double> ZScore(const cv::Mat& grey, const RelitTemplateSource& images, const Similarity2& fit) {
  ObjectModel model;
  model.views.push_back({.source = "square", .width = kSidePx, .height = kSidePx, .outline = {}, .angles = {}});
  return ComputeNccZScore(PrepareSceneForNcc(grey), model, images, 0, fit).value();
}

TEST(NccScore, SeparatesTruePoseFromOtherPoses) {
  const cv::Mat object = Patches({kSidePx, kSidePx}, 6, 1);
  const testing::FlatViewSource views = RescoringSamplesOf(object);
  for (const double contrast : {1.0, 0.3}) {
    const cv::Mat scene = SceneWith(object, contrast);
    // The initial pose has a small error, as that of a vote search.
    const auto right = ZScore(scene, views, PoseAt(kMiddle + Eigen::Vector2d(4, -3), kTurn_rad + 0.06));
    ASSERT_TRUE(right);
    EXPECT_GT(*right, 5) << contrast;
    for (const double x : {100.0, 200.0, 300.0}) {
      const auto wrong = ZScore(scene, views, PoseAt({x, 330}, kTurn_rad));
      ASSERT_TRUE(wrong);
      EXPECT_LT(*wrong, 3) << x;
    }
  }
}

TEST(NccScore, InvertedContrastScoresNegative) {
  const cv::Mat object = Patches({kSidePx, kSidePx}, 6, 1);
  const auto sigmas = ZScore(SceneWith(255 - object, 1), RescoringSamplesOf(object), PoseAt(kMiddle, kTurn_rad));
  ASSERT_TRUE(sigmas);
  EXPECT_LT(*sigmas, 0);
}

// The null distribution: z-scores of false poses have zero mean and unit variance, also at the frame's edge, where
// fewer samples are compared.
TEST(NccScore, FalsePosesAreStandardNormal) {
  const testing::FlatViewSource views = RescoringSamplesOf(Patches({kSidePx, kSidePx}, 6, 1));
  const cv::Mat scene = Patches({640, 480}, 6, 11);
  for (const auto& [left, right] : {std::pair(60.0, 580.0), std::pair(2.0, 8.0)}) {
    Random random(3);
    double sum = 0;
    double sum2 = 0;
    constexpr int kGuesses = 60;
    for (int i = 0; i < kGuesses; ++i) {
      const Eigen::Vector2d at(random.Uniform(left, right), random.Uniform(60, 420));
      const auto sigmas = ZScore(scene, views, PoseAt(at, random.Uniform(-kPi, kPi)));
      ASSERT_TRUE(sigmas);
      sum += *sigmas;
      sum2 += *sigmas * *sigmas;
      EXPECT_LT(*sigmas, 4.5);
    }
    EXPECT_NEAR(sum / kGuesses, 0, 0.5) << left;
    EXPECT_NEAR(std::sqrt(sum2 / kGuesses), 1, 0.5) << left;
  }
}

TEST(NccScore, IsUnknownWithoutSamples) {
  const cv::Mat object = Patches({kSidePx, kSidePx}, 6, 1);
  const cv::Mat scene = SceneWith(object, 1);
  EXPECT_FALSE(ZScore(scene, RescoringSamplesOf(object), PoseAt({-30, 200}, 0)));  // hardly in the frame
  EXPECT_FALSE(ZScore(scene, RescoringSamplesOf(cv::Mat()), PoseAt(kMiddle, 0)));  // no surface samples
  EXPECT_FALSE(
      ZScore(scene(cv::Rect(370, 170, 60, 60)), RescoringSamplesOf(object), PoseAt({30, 30}, 0)));  // no null samples
}

TEST(NccScore, IsDeterministic) {
  const cv::Mat object = Patches({kSidePx, kSidePx}, 6, 1);
  const cv::Mat scene = SceneWith(object, 1);
  EXPECT_EQ(ZScore(scene, RescoringSamplesOf(object), PoseAt({300, 300}, 1)),
            ZScore(scene, RescoringSamplesOf(object), PoseAt({300, 300}, 1)));
}

}  // namespace
}  // namespace victorious

#include "victorious/search/follow/category_follower.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "victorious/base/random.h"

namespace victorious {
namespace {

// A textured square of this side on textured ground, which moves by (dx, dy).
cv::Mat DrawSquare(int side, cv::Point at, cv::Point ground) {
  Random random(5);
  cv::Mat field(400, 500, CV_8UC1);
  for (int y = 0; y < field.rows; ++y) {
    for (int x = 0; x < field.cols; ++x) field.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(random.Below(256));
  }
  cv::GaussianBlur(field, field, {7, 7}, 2);
  cv::Mat grey = field(cv::Rect(40 - ground.x, 40 - ground.y, 320, 240)).clone();
  cv::Mat object;
  cv::resize(field(cv::Rect(300, 200, 40, 40)), object, {side, side}, 0, 0, cv::INTER_LINEAR);
  object = object * 0.5 + 100;
  object.copyTo(grey(cv::Rect(at.x, at.y, side, side)));
  return grey;
}

FoundCategory At(double x, double y, double side) {
  return {.category = 3, .box = {x, y, side, side}, .probability = 0.7};
}

TEST(CategoryFollower, MovesWithTheObjectAndNotWithTheGround) {
  CategoryFollower follower;
  follower.Restart(DrawSquare(40, {100, 90}, {0, 0}), {At(100, 90, 40)});
  for (int i = 1; i <= 10; ++i) {
    const auto now = follower.Follow(DrawSquare(40, {100 + 4 * i, 90 - 2 * i}, {i, 0}), Similarity2{});
    ASSERT_EQ(now.size(), 1);
    EXPECT_GT(IntersectionOverUnion(now[0].box, {100.0 + 4 * i, 90.0 - 2 * i, 40, 40}), 0.9) << i;
    EXPECT_TRUE(now[0].is_tracked);
    EXPECT_EQ(now[0].category, 3);
    EXPECT_EQ(now[0].probability, 0.7);
  }
}

TEST(CategoryFollower, GrowsWithTheObject) {
  CategoryFollower follower;
  follower.Restart(DrawSquare(40, {100, 90}, {0, 0}), {At(100, 90, 40)});
  for (int side = 42; side <= 60; side += 2) {
    const auto now = follower.Follow(DrawSquare(side, {100, 90}, {0, 0}), std::nullopt);
    ASSERT_EQ(now.size(), 1);
    EXPECT_GT(IntersectionOverUnion(now[0].box, {100, 90, double(side), double(side)}), 0.85) << side;
  }
}

TEST(CategoryFollower, EndsWithACutAndBeginsWithTheNextSearch) {
  CategoryFollower follower;
  follower.Restart(DrawSquare(40, {100, 90}, {0, 0}), {At(100, 90, 40)});
  const cv::Mat blank(240, 320, CV_8UC1, cv::Scalar(90));
  EXPECT_TRUE(follower.Follow(blank, std::nullopt).empty());
  EXPECT_TRUE(follower.Follow(DrawSquare(40, {100, 90}, {0, 0}), std::nullopt).empty());
  follower.Restart(DrawSquare(40, {100, 90}, {0, 0}), {At(100, 90, 40)});
  EXPECT_EQ(follower.Follow(DrawSquare(40, {102, 90}, {0, 0}), std::nullopt).size(), 1);
}

TEST(CategoryFollower, LeavesTheFrameWithTheObject) {
  CategoryFollower follower;
  follower.Restart(DrawSquare(40, {276, 90}, {0, 0}), {At(276, 90, 40)});
  const auto still = follower.Follow(DrawSquare(40, {280, 90}, {0, 0}), std::nullopt);
  ASSERT_EQ(still.size(), 1);
  EXPECT_LE(still[0].box.x + still[0].box.width, 320);
}

}  // namespace
}  // namespace victorious

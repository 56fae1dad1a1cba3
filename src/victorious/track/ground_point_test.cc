#include "victorious/track/ground_point.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "testing/drawn_town.h"

namespace victorious {
namespace {

// A view of 400 x 300 px of a town with a dark moving car; the camera translates and approaches.
class View {
 public:
  View() { cv::cvtColor(testing::DrawTown({1100, 900}, 6), town_, cv::COLOR_BGR2GRAY); }

  [[nodiscard]] static Eigen::Vector2d InFrame(const Eigen::Vector2d& on_ground, int frame) {
    return Scale(frame) * (on_ground - Camera(frame)) + Eigen::Vector2d(200, 150);
  }

  [[nodiscard]] cv::Mat Draw(int frame, const Box& car_on_ground) const {
    cv::Mat ground = town_.clone();
    cv::rectangle(ground,
                  cv::Rect(static_cast<int>(car_on_ground.x), static_cast<int>(car_on_ground.y),
                           static_cast<int>(car_on_ground.width), static_cast<int>(car_on_ground.height)),
                  cv::Scalar(15), cv::FILLED);
    const Eigen::Vector2d offset = InFrame({0.5, 0.5}, frame) - Eigen::Vector2d(0.5, 0.5);
    cv::Mat drawn;
    cv::warpAffine(ground, drawn, cv::Matx23d(Scale(frame), 0, offset.x(), 0, Scale(frame), offset.y()), {400, 300});
    return drawn;
  }

 private:
  static double Scale(int frame) { return 1 + 0.01 * frame; }
  static Eigen::Vector2d Camera(int frame) { return {500.0 + 4 * frame, 400.0 - 3 * frame}; }

  cv::Mat town_;
};

Box CarOnGround(int frame) { return {485.0 + 5 * frame, 390, 30, 20}; }

Box CarInFrame(int frame) {
  const Box car = CarOnGround(frame);
  const Eigen::Vector2d from = View::InFrame({car.x, car.y}, frame);
  const Eigen::Vector2d to = View::InFrame({car.x + car.width, car.y + car.height}, frame);
  return {from.x(), from.y(), to.x() - from.x(), to.y() - from.y()};
}

TEST(GroundPointTracker, StaysOnTheGroundWhenTheCarDrivesAway) {
  const View view;
  const Eigen::Vector2d spot(500, 400);
  GroundPointTracker ground(FlowPyramid(view.Draw(0, CarOnGround(0))), CarInFrame(0));
  for (int i = 1; i <= 20; ++i) {
    const auto position = ground.Step(FlowPyramid(view.Draw(i, CarOnGround(i))), CarInFrame(i - 1));
    ASSERT_TRUE(position) << i;
    EXPECT_LT((*position - View::InFrame(spot, i)).norm(), 1.5) << i;
  }
}

TEST(GroundPointTracker, IsLostOutsideTheFrameOrWithoutFeatures) {
  const View view;
  GroundPointTracker leaves(FlowPyramid(view.Draw(0, CarOnGround(0))), CarInFrame(0));
  int seen = 0;
  for (int i = 1; i <= 60; ++i) {
    const auto position = leaves.Step(FlowPyramid(view.Draw(i, CarOnGround(0))), std::nullopt);
    if (!position) continue;
    EXPECT_EQ(++seen, i) << "a lost point stays lost";
    EXPECT_GE(position->x(), 0);
  }
  EXPECT_GT(seen, 30);
  EXPECT_LT(seen, 60);
  GroundPointTracker blind(FlowPyramid(cv::Mat(300, 400, CV_8UC1, cv::Scalar(90))), {100, 100, 30, 20});
  EXPECT_FALSE(blind.Step(FlowPyramid(cv::Mat(300, 400, CV_8UC1, cv::Scalar(90))), std::nullopt));
  GroundPointTracker resized(FlowPyramid(view.Draw(0, CarOnGround(0))), CarInFrame(0));
  EXPECT_FALSE(resized.Step(FlowPyramid(cv::Mat(30, 40, CV_8UC1, cv::Scalar(90))), std::nullopt));
}

}  // namespace
}  // namespace victorious

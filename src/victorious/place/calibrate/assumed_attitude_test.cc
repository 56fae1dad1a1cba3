#include "victorious/place/calibrate/assumed_attitude.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "victorious/geometry/angles.h"
#include "victorious/geometry/attitude.h"
#include "victorious/geometry/camera.h"

namespace victorious {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

const cv::Size kImage(640, 480);

// The motion of the image of level ground below a camera that turns about the vertical while it flies sideways.
ImageMotions Film(double turn_rate_rad_s, double off_nadir_rad, double speed_m_s) {
  const double focal_px = FocalLengthPx(RadiansFromDegrees(20), kImage.width);
  const Vector2d middle(kImage.width / 2.0, kImage.height / 2.0);
  ImageMotions seen{.motions = {}, .image = kImage};
  for (int i = 0; i < 80; ++i) {
    const auto camera_at = [&](int at) {
      return CameraFromEnu({turn_rate_rad_s * 0.1 * at, off_nadir_rad - kPi / 2, 0});
    };
    std::vector<PointPair> pairs;
    for (int k = 0; k < 60; ++k) {
      const Vector2d pixel((37 * k) % 640, (53 * k) % 480);
      const Vector3d ray = camera_at(i).conjugate() * ((pixel - middle) / focal_px).homogeneous();
      const Vector3d point = -100 / ray.z() * ray;
      const Vector3d there = camera_at(i + 1) * (point - Vector3d(0.1 * speed_m_s, 0, 0));
      pairs.push_back({pixel, focal_px * there.hnormalized() + middle});
    }
    seen.motions.push_back({.from_s = 0.1 * i, .to_s = 0.1 * (i + 1), .flow = FitImageFlow(pairs, kImage)});
  }
  return seen;
}

TEST(AssumedAttitude, TurnsAsTheImageDoes) {
  for (const double degrees : {35.0, 55.0}) {
    const std::vector<CameraState> states =
        AssumeAttitudes(Film(0.2, RadiansFromDegrees(degrees), 8), RadiansFromDegrees(degrees));
    ASSERT_EQ(states.size(), 81U);
    EXPECT_EQ(states.front().attitude->yaw_rad, 0);
    EXPECT_NEAR(states.back().attitude->yaw_rad, 1.6, 0.08);
    EXPECT_NEAR(DegreesFromRadians(states.back().attitude->pitch_rad), degrees - 90, 1e-9);
  }
}

TEST(AssumedAttitude, OfAStraightFlightDoesNotTurn) {
  const std::vector<CameraState> states = AssumeAttitudes(Film(0, RadiansFromDegrees(45), 10), RadiansFromDegrees(45));
  ASSERT_FALSE(states.empty());
  EXPECT_NEAR(states.back().attitude->yaw_rad, 0, 0.02);
}

TEST(AssumedAttitude, ACutVideoHasNone) {
  ImageMotions seen = Film(0.2, RadiansFromDegrees(45), 8);
  for (std::size_t i = 30; i < 45; ++i) seen.motions[i].flow.reset();
  EXPECT_TRUE(AssumeAttitudes(seen, RadiansFromDegrees(45)).empty());
  EXPECT_TRUE(AssumeAttitudes({}, RadiansFromDegrees(45)).empty());
}

}  // namespace
}  // namespace victorious

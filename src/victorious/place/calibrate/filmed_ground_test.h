// Flights over flat ground: the motion of their images, and their telemetry, for the tests of calibration.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <opencv2/core/types.hpp>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/attitude.h"
#include "victorious/geometry/geodesy.h"
#include "victorious/geometry/solvers/similarity.h"
#include "victorious/input/telemetry/camera_track.h"
#include "victorious/place/calibrate/time_offset.h"

namespace victorious {

inline const GeodeticPoint kFilmedOrigin{RadiansFromDegrees(48), RadiansFromDegrees(11), 400};
inline const cv::Size kImage(640, 480);
inline const double kHfov = RadiansFromDegrees(18);

// 15 s of camera poses over flat ground at the height of the origin.
using FlightPath = std::function<CameraState(double time_s)>;

inline CameraState Above(const Eigen::Vector3d& enu, double yaw_deg, double pitch_deg, double roll_deg, double time_s) {
  return {
      .time_s = time_s,
      .place = TangentPlane(kFilmedOrigin).GeodeticFromEnu(enu),
      .attitude = Attitude{RadiansFromDegrees(yaw_deg), RadiansFromDegrees(pitch_deg), RadiansFromDegrees(roll_deg)},
      .hfov_rad = kHfov};
}

inline CameraState Swerving(double time_s) {
  return Above({8 * time_s, -60, 110}, 2 * std::sin(0.9 * time_s) - 6 * time_s + 0.4 * std::sin(5.3 * time_s),
               -60 + 3 * std::sin(0.6 * time_s + 1) + 0.3 * std::sin(7.1 * time_s), 2 * std::sin(0.4 * time_s), time_s);
}

inline CameraState Straight(double time_s) { return Above({8 * time_s, -60, 110}, 0, -60, 0, time_s); }

inline CameraState Rocking(double time_s) {
  return Above({0, -60, 110}, 2 * std::sin(2 * kPi * time_s / 0.8), -60, 0, time_s);
}

inline constexpr double kLength_s = 15;

// Image motion of ground points seen from this path, with tracking noise.
inline ImageMotions Film(const FlightPath& path, std::uint64_t seed = 1, double noise_px = 0.15) {
  Random random(seed);
  const TangentPlane plane(kFilmedOrigin);
  const double focal_px = kImage.width / 2.0 / std::tan(kHfov / 2);
  const Eigen::Vector2d middle(kImage.width / 2.0, kImage.height / 2.0);
  ImageMotions seen{.motions = {}, .image = kImage};
  for (int i = 0; i + 1 < kLength_s * 10; ++i) {
    const CameraState from = path(0.1 * i);
    const CameraState to = path(0.1 * (i + 1));
    std::vector<PointPair> pairs;
    const Eigen::Vector2d shift(noise_px * random.Normal(), noise_px * random.Normal());
    const Eigen::Rotation2Dd turn(noise_px / 400 * random.Normal());
    for (int k = 0; k < 40; ++k) {
      const Eigen::Vector2d pixel(random.Uniform(0, kImage.width), random.Uniform(0, kImage.height));
      const Eigen::Vector3d ray =
          CameraFromEnu(*from.attitude).conjugate() * ((pixel - middle) / focal_px).homogeneous();
      const Eigen::Vector3d at = plane.EnuFromGeodetic(from.place);
      const Eigen::Vector3d ground = at - at.z() / ray.z() * ray;
      const Eigen::Vector3d there = CameraFromEnu(*to.attitude) * (ground - plane.EnuFromGeodetic(to.place));
      pairs.push_back({pixel, turn * (focal_px * there.hnormalized()) + middle + shift});
    }
    const auto map = SolveSimilarity(pairs);
    EXPECT_TRUE(map);
    seen.motions.push_back({from.time_s, to.time_s, *map, FitImageFlow(pairs, kImage)});
  }
  return seen;
}

// Its telemetry, 10 states per second, with a clock error of `late_s`.
inline CameraTrajectory RecordedLate(const FlightPath& path, double late_s) {
  std::vector<CameraState> states;
  for (int i = -30; i < (kLength_s + 3) * 10; ++i) {
    states.push_back(path(0.1 * i));
    states.back().time_s += late_s;
  }
  return {std::move(states), 2};
}

}  // namespace victorious

#include "victorious/place/calibrate/field_of_view.h"

#include <cmath>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/camera.h"
#include "victorious/geometry/geodesy.h"
#include "victorious/geometry/solvers/similarity.h"

namespace victorious {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

const GeodeticPoint kOrigin{RadiansFromDegrees(48), RadiansFromDegrees(11), 400};
const cv::Size kImage(640, 480);
const double kHfov_rad = RadiansFromDegrees(18);
constexpr double kLength_s = 12;

using Path = std::function<CameraState(double time_s)>;

CameraState Above(const Vector3d& enu, double yaw_deg, double pitch_deg, double time_s) {
  return {.time_s = time_s,
          .place = TangentPlane(kOrigin).GeodeticFromEnu(enu),
          .attitude = Attitude{RadiansFromDegrees(yaw_deg), RadiansFromDegrees(pitch_deg), 0},
          .hfov_rad = kHfov_rad};
}

CameraState SideLooking(double time_s) { return Above({10 * time_s, -60, 100}, 0, -53, time_s); }
CameraState DownLooking(double time_s) { return Above({10 * time_s, -60, 100}, 0, -90, time_s); }
CameraState ForwardLooking(double time_s) { return Above({10 * time_s, -60, 100}, 90, -53, time_s); }
CameraState Circling(double time_s, double aside_deg) {
  const double angle_rad = 0.3 * time_s;
  return Above({75 * std::sin(angle_rad), -75 * std::cos(angle_rad), 100}, aside_deg - DegreesFromRadians(angle_rad),
               -53, time_s);
}
CameraState CirclingAside(double time_s) { return Circling(time_s, 6); }
CameraState CirclingOnePoint(double time_s) { return Circling(time_s, 0); }

std::optional<FocalMeasurement> MeasureFocalLength(const ImageMotions& seen, const CameraTrajectory& cameras) {
  return FocalOf(MeasureCameraErrors(seen, cameras));
}

// The motion of the image over ground that rises to the north by this slope, with tracking noise and corners that
// stand above the ground.
ImageMotions Film(const Path& path, double slope = 0) {
  Random random(7);
  const TangentPlane plane(kOrigin);
  const double focal_px = FocalLengthPx(kHfov_rad, kImage.width);
  const Vector2d middle(kImage.width / 2.0, kImage.height / 2.0);
  const Vector3d normal(0, -slope, 1);
  ImageMotions seen{.motions = {}, .image = kImage};
  for (int i = 0; i + 1 < kLength_s * 10; ++i) {
    const CameraState from = path(0.1 * i);
    const CameraState to = path(0.1 * (i + 1));
    std::vector<PointPair> pairs;
    for (int k = 0; k < 60; ++k) {
      const Vector2d pixel(random.Uniform(0, kImage.width), random.Uniform(0, kImage.height));
      const Vector3d ray = CameraFromEnu(*from.attitude).conjugate() * ((pixel - middle) / focal_px).homogeneous();
      const Vector3d at = plane.EnuFromGeodetic(from.place);
      const double height_m = k % 10 == 0 ? 8 : 0;
      const Vector3d point = at + (height_m - normal.dot(at)) / normal.dot(ray) * ray;
      const Vector3d there = CameraFromEnu(*to.attitude) * (point - plane.EnuFromGeodetic(to.place));
      pairs.push_back(
          {pixel, focal_px * there.hnormalized() + middle + 0.2 * Vector2d(random.Normal(), random.Normal())});
    }
    seen.motions.push_back({.from_s = from.time_s, .to_s = to.time_s, .flow = FitImageFlow(pairs, kImage)});
  }
  return seen;
}

// Its telemetry, with a focal length of exp(-log_factor) times the true one.
CameraTrajectory Recorded(const Path& path, double log_factor) {
  std::vector<CameraState> states;
  for (int i = -2; i < (kLength_s + 1) * 10; ++i) {
    states.push_back(path(0.1 * i));
    states.back().hfov_rad = 2 * std::atan(std::tan(kHfov_rad / 2) * std::exp(log_factor));
  }
  return {std::move(states), 2};
}

TEST(ImageFlow, IsThatOfTheGroundWithoutWhatStandsOnIt) {
  std::vector<PointPair> pairs;
  for (int i = 0; i < 60; ++i) {
    const Vector2d at((37 * i) % 640, (53 * i) % 480);
    const Vector2d off = at - Vector2d(320, 240);
    Vector2d shift = Vector2d(5, -2) + Vector2d(0.01 * off.x() + 0.02 * off.y(), -0.03 * off.x());
    if (i % 5 == 0) shift.x() += 9;
    pairs.push_back({at, at + shift});
  }
  const auto flow = FitImageFlow(pairs, kImage);
  ASSERT_TRUE(flow);
  EXPECT_LT((flow->centre_px - Vector2d(5, -2)).norm(), 0.02);
  Eigen::Matrix2d gradient;
  gradient << 0.01, 0.02, -0.03, 0;
  EXPECT_LT((flow->gradient - gradient).norm(), 2e-4);
  EXPECT_FALSE(FitImageFlow(std::span(pairs).first(15), kImage));
  for (PointPair& pair : pairs) pair.source.y() = 100;
  EXPECT_FALSE(FitImageFlow(pairs, kImage)) << "on a line";
}

TEST(FocalLength, FollowsFromObliqueGroundPastAStraightFlight) {
  for (const Path& path : {Path(SideLooking), Path(ForwardLooking)}) {
    const ImageMotions seen = Film(path);
    for (const double log_factor : {0.0, std::log(1.2), std::log(0.8)}) {
      const auto measured = MeasureFocalLength(seen, Recorded(path, log_factor));
      ASSERT_TRUE(measured);
      EXPECT_NEAR(measured->log_factor, log_factor, 0.05);
      EXPECT_LT(measured->sigma, 0.12);
    }
  }
  EXPECT_GT(MeasureFocalLength(Film(SideLooking), Recorded(SideLooking, 0))->sigma, 0.04) << "the ground may slope";
}

TEST(FocalLength, FollowsFromTheTurnOfTheCamera) {
  const auto measured = MeasureFocalLength(Film(CirclingAside), Recorded(CirclingAside, std::log(1.2)));
  ASSERT_TRUE(measured);
  EXPECT_NEAR(measured->log_factor, std::log(1.2), 0.06);
  EXPECT_LT(measured->sigma, 0.05);
}

// The point stays in the middle of the image, and all around it turns, whatever the focal length.
TEST(FocalLength, IsUnknownIfTheCameraLooksAtOnePoint) {
  const auto measured = MeasureFocalLength(Film(CirclingOnePoint), Recorded(CirclingOnePoint, std::log(1.2)));
  ASSERT_TRUE(measured);
  EXPECT_GT(measured->sigma, 0.3);
  EXPECT_EQ(JudgeFieldOfView(measured).log_factor, 0);
}

TEST(FocalLength, IsUnknownFromStraightAbove) {
  const auto measured = MeasureFocalLength(Film(DownLooking), Recorded(DownLooking, std::log(1.2)));
  ASSERT_TRUE(measured);
  EXPECT_GT(measured->sigma, 0.3);
}

TEST(FocalLength, ASlopeOfTheGroundIsWithinTheError) {
  const double slope = std::tan(RadiansFromDegrees(3));
  const auto measured = MeasureFocalLength(Film(SideLooking, slope), Recorded(SideLooking, 0));
  ASSERT_TRUE(measured);
  EXPECT_LT(std::abs(measured->log_factor), 2.5 * measured->sigma);
  EXPECT_EQ(JudgeFieldOfView(measured).log_factor, 0);
}

// Noise from state to state is as much motion as the camera's: the fit would take it for a wrong focal length.
TEST(FocalLength, IsUnknownWithNoisyTelemetry) {
  Random random(3);
  const auto measured = [&](double attitude_deg, double place_m) {
    std::vector<CameraState> states = Recorded(CirclingAside, 0).states();
    for (CameraState& state : states) {
      for (double* angle_rad : {&state.attitude->yaw_rad, &state.attitude->pitch_rad, &state.attitude->roll_rad})
        *angle_rad += RadiansFromDegrees(attitude_deg) * random.Normal();
      const TangentPlane plane(state.place);
      state.place = plane.GeodeticFromEnu(place_m * Vector3d(random.Normal(), random.Normal(), random.Normal()));
    }
    return MeasureFocalLength(Film(CirclingAside), CameraTrajectory(std::move(states), 2));
  };
  const auto exact = measured(0.03, 0.05);
  ASSERT_TRUE(exact);
  EXPECT_LT(std::abs(exact->log_factor), 0.05);
  EXPECT_FALSE(measured(0.5, 0));
  EXPECT_FALSE(measured(0, 2));
}

// It looks at one point, then quickly turns to another.
CameraState Staring(double time_s) {
  const Vector3d place(25 * time_s, -2000, 3000);
  const Vector3d to = Vector3d(std::clamp(time_s - 11, 0.0, 1.0) * 900, 0, 0) - place;
  return Above(place, DegreesFromRadians(std::atan2(to.x(), to.y())),
               DegreesFromRadians(std::atan2(to.z(), to.head<2>().norm())), time_s);
}

std::optional<FocalMeasurement> MeasureStaring(const ImageMotions& seen, double late_s) {
  const auto late = [&](double time_s) {
    CameraState state = Staring(time_s - late_s);
    state.time_s = time_s;
    return state;
  };
  return MeasureFocalLength(seen, Recorded(late, 0));
}

// One second decides, and telemetry is late by less than its clock is known.
TEST(FocalLength, IsNotKnownByOneSlewAlone) {
  EXPECT_EQ(JudgeFieldOfView(MeasureStaring(Film(Staring), 0.06)).log_factor, 0);
}

// In the slew the tracker sees something else: the fit went to a focal length 16 times as long, with worse residuals
// than telemetry's.
TEST(FocalLength, IsNotThatOfAFitThatLeavesTheMotion) {
  for (const double across : {-0.1, -0.03, 0.03, 0.1}) {
    ImageMotions seen = Film(Staring);
    for (ImageMotion& motion : seen.motions) {
      if (motion.from_s < 11) continue;
      motion.flow->centre_px *= 0.8;
      motion.flow->gradient << across, -across, across / 3, across / 2;
    }
    EXPECT_EQ(JudgeFieldOfView(MeasureStaring(seen, 0)).log_factor, 0) << across;
  }
}

TEST(FocalLength, NeedsTelemetryAndFourSeconds) {
  EXPECT_FALSE(MeasureFocalLength(Film(SideLooking), CameraTrajectory({}, 2)));
  ImageMotions seen = Film(SideLooking);
  seen.motions.resize(25);
  EXPECT_FALSE(MeasureFocalLength(seen, Recorded(SideLooking, 0)));
}

// The telemetry of a camera whose compass is off.
CameraTrajectory Misdirected(const Path& path, double error_deg, double log_factor = 0) {
  std::vector<CameraState> states = Recorded(path, log_factor).states();
  for (CameraState& state : states) state.attitude->yaw_rad += RadiansFromDegrees(error_deg);
  return {std::move(states), 2};
}

TEST(Yaw, FollowsFromTheCoursePastAStraightFlight) {
  for (const Path& path : {Path(SideLooking), Path(ForwardLooking), Path(DownLooking)}) {
    const ImageMotions seen = Film(path);
    for (const double error_deg : {0.0, 5.0, -12.0}) {
      const auto yaw = MeasureCameraErrors(seen, Misdirected(path, error_deg))->yaw;
      ASSERT_TRUE(yaw) << error_deg << " degrees, elevation " << DegreesFromRadians(path(0).attitude->pitch_rad);
      EXPECT_NEAR(DegreesFromRadians(yaw->error_rad), error_deg, 0.5);
      EXPECT_LT(yaw->sigma_rad, RadiansFromDegrees(1));
      EXPECT_EQ(SignificantYawError(*yaw).has_value(), error_deg != 0);
    }
    const auto both = MeasureCameraErrors(seen, Misdirected(path, 5, std::log(1.2)))->yaw;
    EXPECT_NEAR(DegreesFromRadians(both->error_rad), 5, 1) << "with a wrong field of view";
  }
}

TEST(Yaw, IsLeftToOthersInATurn) {
  EXPECT_FALSE(MeasureCameraErrors(Film(CirclingAside), Misdirected(CirclingAside, 5))->yaw);
}

TEST(Yaw, IsSignificantBeyondItsErrorAndThatOfCompasses) {
  constexpr double kDegree_rad = RadiansFromDegrees(1);
  EXPECT_EQ(SignificantYawError({-5 * kDegree_rad, 0.6 * kDegree_rad}), -5 * kDegree_rad);
  EXPECT_FALSE(SignificantYawError({5 * kDegree_rad, 2 * kDegree_rad}));
  EXPECT_FALSE(SignificantYawError({1.2 * kDegree_rad, 0.1 * kDegree_rad}));
}

TEST(FieldOfView, IsCorrectedIfItIsMoreLikelyWrongThanRight) {
  const FieldOfViewVerdict right = JudgeFieldOfView(FocalMeasurement{0.02, 0.07});
  EXPECT_EQ(right.log_factor, 0);
  EXPECT_LT(right.sigma, 0.03);
  const FieldOfViewVerdict wrong = JudgeFieldOfView(FocalMeasurement{0.2, 0.01});
  EXPECT_NEAR(wrong.log_factor, 0.2, 0.005);
  EXPECT_NEAR(wrong.sigma, 0.01, 0.001);
  EXPECT_GT(wrong.wrong_probability, 0.99);
  const FieldOfViewVerdict doubtful = JudgeFieldOfView(FocalMeasurement{-0.18, 0.07});
  EXPECT_EQ(doubtful.log_factor, 0);
  // One of three is wrong, by 0.16 +- 0.07: 90 % lie within 0.2.
  EXPECT_NEAR(doubtful.wrong_probability, 0.36, 0.01);
  EXPECT_NEAR(1.645 * doubtful.sigma, 0.2, 0.01) << "the error contains the doubt";
  const FieldOfViewVerdict unknown = JudgeFieldOfView(std::nullopt);
  EXPECT_EQ(unknown.log_factor, 0);
  EXPECT_NEAR(unknown.sigma, JudgeFieldOfView(FocalMeasurement{0, 100}).sigma, 1e-3);
}

}  // namespace
}  // namespace victorious

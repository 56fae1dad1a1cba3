#include "victorious/place/calibrate/time_offset.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "testing/data.h"
#include "testing/drawn_town.h"
#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/solvers/similarity.h"
#include "victorious/place/calibrate/filmed_ground_test.h"
#include "victorious/place/calibrate/motion_contradiction.h"

namespace victorious {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using ::testing::HasSubstr;

TEST(EstimateTimeOffset, ManoeuvringFlightGivesSubFrameOffset) {
  for (const double late_s : {0.0, 0.4, -0.25, 0.037, 1.7}) {
    const TimeOffset offset = EstimateTimeOffset(Film(Swerving), RecordedLate(Swerving, late_s), {});
    ASSERT_TRUE(offset.offset_s) << late_s << ": " << DescribeStatus(offset);
    EXPECT_NEAR(*offset.offset_s, -late_s, 0.01);
    EXPECT_LT(offset.sigma_s, 0.01);
    EXPECT_GT(offset.explained, 0.9);
  }
}

TEST(EstimateTimeOffset, StandardErrorIsConsistent) {
  constexpr int kDraws = 40;
  int inside = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    const auto seen = Film(Swerving, 100 + static_cast<std::uint64_t>(draw), 1.5);
    const TimeOffset offset = EstimateTimeOffset(seen, RecordedLate(Swerving, 0.2), {});
    ASSERT_TRUE(offset.offset_s) << DescribeStatus(offset);
    inside += std::abs(*offset.offset_s + 0.2) < 1.645 * offset.sigma_s ? 1 : 0;
  }
  EXPECT_GE(inside, 0.8 * kDraws);
}

TEST(EstimateTimeOffset, TelemetryNoiseDoesNotBiasOffset) {
  int inside = 0;
  constexpr int kDraws = 20;
  for (int draw = 0; draw < kDraws; ++draw) {
    Random random(static_cast<std::uint64_t>(draw) + 5);
    std::vector<CameraState> states = RecordedLate(Swerving, 0.4).states();
    for (CameraState& state : states) {
      state.attitude->yaw_rad += 1e-3 * random.Normal();
      state.attitude->pitch_rad += 1e-3 * random.Normal();
    }
    const TimeOffset offset = EstimateTimeOffset(Film(Swerving), CameraTrajectory(states, 2), {});
    ASSERT_TRUE(offset.offset_s) << DescribeStatus(offset);
    EXPECT_NEAR(*offset.offset_s, -0.4, 0.05);
    inside += std::abs(*offset.offset_s + 0.4) < 1.645 * offset.sigma_s ? 1 : 0;
  }
  EXPECT_GE(inside, 0.7 * kDraws);
}

TEST(EstimateTimeOffset, StraightFlightIsNotObservable) {
  const TimeOffset offset = EstimateTimeOffset(Film(Straight), RecordedLate(Straight, 0.4), {});
  EXPECT_FALSE(offset.offset_s);
  EXPECT_EQ(offset.status, TimeOffsetStatus::kUncertain);
  EXPECT_THAT(Describe(offset), HasSubstr("too little"));
}

// Circles a point on the ground, which stays in the middle of the image.
CameraState Circling(double time_s) {
  const double turn_deg = 6 * time_s;
  const double turn = RadiansFromDegrees(turn_deg);
  return Above({-70 * std::sin(turn), -70 * std::cos(turn), 110}, turn_deg, -57.5, 0, time_s);
}

TEST(EstimateTimeOffset, SteadyTelemetryOfAnotherFlightIsContradicted) {
  const TimeOffset circling = EstimateTimeOffset(Film(Circling), RecordedLate(Straight, 0), {});
  EXPECT_FALSE(circling.offset_s);
  ASSERT_TRUE(circling.contradicted) << DescribeStatus(circling);
  EXPECT_GT(std::abs(circling.contradicted->seen_px_s.z()), 10) << "the image turns";
  EXPECT_LT(std::abs(circling.contradicted->predicted_px_s.z()), 5) << "by the telemetry it does not";
  EXPECT_TRUE(FindContradiction(Film(Straight), RecordedLate(Circling, 0)));
}

TEST(EstimateTimeOffset, TheFlightsOwnTelemetryIsNotContradicted) {
  for (const FlightPath& path : {FlightPath(Straight), FlightPath(Circling), FlightPath(Swerving)}) {
    EXPECT_FALSE(FindContradiction(Film(path), RecordedLate(path, 0)));
    EXPECT_FALSE(FindContradiction(Film(path), RecordedLate(path, 0.4)));
  }
  // Yaw 5 degrees and field of view 20 % wrong: the mean motion is still that of the flight.
  const auto spoilt = [](double time_s) {
    CameraState state = Straight(time_s);
    state.attitude->yaw_rad += RadiansFromDegrees(5);
    *state.hfov_rad *= 1.2;
    return state;
  };
  EXPECT_FALSE(FindContradiction(Film(Straight), RecordedLate(spoilt, 0)));
  // A yaw that was given once for the flight, in which the camera turns by 2 degrees a second.
  const auto turning = [](double time_s) { return Above({8 * time_s, -60, 110}, 2 * time_s, -60, 0, time_s); };
  const auto with_one_yaw = [](double time_s) { return Above({8 * time_s, -60, 110}, kLength_s, -60, 0, time_s); };
  EXPECT_FALSE(FindContradiction(Film(turning), RecordedLate(with_one_yaw, 0)));
  // Positions of one second repeated, as some telemetry has them.
  const auto stepping = [](double time_s) {
    CameraState state = Straight(std::floor(time_s));
    state.time_s = time_s;
    return state;
  };
  EXPECT_FALSE(FindContradiction(Film(Straight), RecordedLate(stepping, 0)));
  const auto hovering = [](double time_s) { return Above({0, -60, 110}, 0, -60, 0, time_s); };
  EXPECT_FALSE(FindContradiction(Film(hovering), RecordedLate(hovering, 0)));
  // About one point: what the way of the camera would move the image by, its turn takes back, at the right height only.
  for (const double height_m : {80.0, 90.0, 100.0, 120.0}) {
    const auto orbiting = [&](double time_s) {
      const double azimuth_rad = 0.8 * time_s;
      const double radius_m = height_m * std::tan(RadiansFromDegrees(40));
      return Above({-radius_m * std::sin(azimuth_rad), -radius_m * std::cos(azimuth_rad), height_m},
                   DegreesFromRadians(azimuth_rad), -50, 0, time_s);
    };
    EXPECT_FALSE(FindContradiction(Film(orbiting), RecordedLate(orbiting, 0))) << height_m;
  }
  // Just after take-off: the ground is nearer than in any survey.
  const auto low = [](double time_s) { return Above({0.5 * time_s, -60, 2}, 0, -60, 0, time_s); };
  EXPECT_FALSE(FindContradiction(Film(low), RecordedLate(low, 0)));
}

TEST(EstimateTimeOffset, PeriodicMotionIsAmbiguous) {
  const TimeOffset offset = EstimateTimeOffset(Film(Rocking), RecordedLate(Rocking, 0.3), {});
  EXPECT_FALSE(offset.offset_s);
  EXPECT_EQ(offset.status, TimeOffsetStatus::kPeriodic);
  EXPECT_THAT(Describe(offset), HasSubstr("is periodic"));
}

// A camera that shakes by 0.35 degrees at 1.3 Hz on a straight flight, and a telemetry with noise of 0.1 degrees a row.
TEST(EstimateTimeOffset, NoiseOfTelemetryDoesNotChooseBetweenPeriodsOfAShake) {
  constexpr int kDraws = 8;
  int ambiguous = 0;
  for (std::uint64_t draw = 1; draw <= kDraws; ++draw) {
    Random random(draw);
    const auto shaking = [](double time_s) {
      const double phase = 2 * kPi * 1.3 * time_s;
      return Above({8 * time_s, -60, 110}, 0.35 * std::sin(phase), -60 + 0.6 * time_s + 0.35 * std::cos(phase),
                   0.3 * time_s, time_s);
    };
    std::vector<CameraState> states = RecordedLate(shaking, 0).states();
    for (CameraState& state : states) {
      for (double* angle : {&state.attitude->yaw_rad, &state.attitude->pitch_rad, &state.attitude->roll_rad})
        *angle += RadiansFromDegrees(0.1) * random.Normal();
    }
    const TimeOffset offset = EstimateTimeOffset(Film(shaking, draw, 0.3), CameraTrajectory(states, 2), {});
    EXPECT_FALSE(offset.offset_s) << Describe(offset);
    ambiguous += offset.status == TimeOffsetStatus::kPeriodic ? 1 : 0;
  }
  EXPECT_GE(ambiguous, kDraws - 1);
}

TEST(EstimateTimeOffset, TelemetryOfAnotherFlightGivesNoOffset) {
  const auto other = [](double time_s) {
    return Above({8 * time_s, -60, 110}, 3 * std::sin(1.7 * time_s + 2), -60 + 2 * std::sin(2.3 * time_s), 0, time_s);
  };
  const TimeOffset offset = EstimateTimeOffset(Film(Swerving), RecordedLate(other, 0), {});
  EXPECT_FALSE(offset.offset_s) << *offset.offset_s;
}

TEST(EstimateTimeOffset, MissingFieldOfViewOrMotionsGiveNoOffset) {
  const auto blind = [](double time_s) {
    CameraState state = Swerving(time_s);
    state.hfov_rad.reset();
    return state;
  };
  EXPECT_EQ(EstimateTimeOffset(Film(Swerving), RecordedLate(blind, 0), {}).status, TimeOffsetStatus::kNoAttitude);
  const TimeOffset none = EstimateTimeOffset({.motions = {}, .image = kImage}, RecordedLate(Swerving, 0), {});
  EXPECT_EQ(none.status, TimeOffsetStatus::kFewPairs);
  EXPECT_THAT(DescribeStatus(none), HasSubstr("0 pairs"));
}

TEST(TimeOffset, UncertaintyIsSaidWithinTheSearchedRange) {
  const auto describe = [](double sigma_s) {
    return DescribeStatus({.status = TimeOffsetStatus::kUncertain, .sigma_s = sigma_s, .max_offset_s = 4});
  };
  EXPECT_THAT(describe(0.734), HasSubstr("the standard error would be 0.73 s"));
  EXPECT_THAT(describe(8.2e4), HasSubstr("more than the searched range of 4 s"));
  EXPECT_THAT(describe(std::numeric_limits<double>::quiet_NaN()), HasSubstr("more than the searched range"));
}

// A camera that moves by whole pixels over a drawn town, with salt-and-pepper noise on a tenth of the pixels.
TEST(TimeOffset, ImpulseFractionDecidesWhetherFramesAreCleanedBeforeTheirMotionIsMeasured) {
  const testing::ScratchFolder folder;
  const cv::Mat town = testing::DrawTown({330, 260}, 3);
  constexpr int kImages = 6;
  constexpr int kStep_px = 3;
  Random random(1);
  for (int i = 0; i < kImages; ++i) {
    cv::Mat frame = town(cv::Rect(kStep_px * i, 0, 300, 240)).clone();
    for (auto& pixel : cv::Mat_<cv::Vec3b>(frame)) {
      const double draw = random.Uniform();
      if (draw < 0.1) pixel = draw < 0.05 ? cv::Vec3b::all(0) : cv::Vec3b::all(255);
    }
    ASSERT_TRUE(cv::imwrite((folder / ("frame" + std::to_string(i) + ".png")).string(), frame));
  }
  const auto mean_error_px = [&](double impulse_fraction) {
    TimedTelemetryOptions parameters;
    const auto json = nlohmann::json{{"features.impulse_fraction", impulse_fraction}};
    EXPECT_TRUE(SetFromJson(json, CollectFields(parameters)));
    const auto seen =
        MeasureMotions(folder.path().string(), parameters.offset, parameters.impulse_fraction, CancelToken());
    EXPECT_TRUE(seen) << seen.error().message;
    double sum_px = 0;
    for (int i = 0; i + 1 < kImages; ++i) {
      const double from_s = 0.1 * i;  // of a folder, ten frames per second
      const auto pair = std::ranges::find_if(
          seen->motions, [&](const ImageMotion& motion) { return std::abs(motion.from_s - from_s) < 1e-6; });
      const Vector2d middle(150, 120);
      sum_px += pair == seen->motions.end() ? kStep_px  // not measured
                                            : (pair->to_from.Apply(middle) - middle + Vector2d(kStep_px, 0)).norm();
    }
    return sum_px / (kImages - 1);
  };
  const double cleaned_px = mean_error_px(0.015);
  EXPECT_LT(cleaned_px, 0.2);
  EXPECT_GT(mean_error_px(1), 2 * cleaned_px) << "1: never cleaned";
}

}  // namespace
}  // namespace victorious

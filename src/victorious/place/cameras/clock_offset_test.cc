#include "victorious/place/cameras/clock_offset.h"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "testing/data.h"
#include "victorious/base/file.h"
#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

TEST(ClockCorrection, OnlySignificantOffsetsAreCorrected) {
  EXPECT_EQ(ClockCorrection({.offset_s = -1.703, .sigma_s = 0.007}), -1.703);
  EXPECT_EQ(ClockCorrection({.offset_s = 0.3, .sigma_s = 0.009}), 0.3);
  EXPECT_FALSE(ClockCorrection({.offset_s = -0.002, .sigma_s = 0.009})) << "exact telemetry";
  EXPECT_FALSE(ClockCorrection({.offset_s = 0.04, .sigma_s = 0.002})) << "within the time stamps of frames";
  EXPECT_FALSE(ClockCorrection({.offset_s = 0.2, .sigma_s = 0.09})) << "within its error";
  EXPECT_FALSE(ClockCorrection({.status = TimeOffsetStatus::kUncertain, .sigma_s = 40, .best_s = -1.7}));
}

TEST(ClockCorrection, ShiftedStatesAreThoseOfAnotherTime) {
  const testing::ScratchFolder folder;
  const std::string path = (folder.path() / "telemetry.csv").string();
  ASSERT_TRUE(WriteFileAtomically(
      path,
      "time_s,latitude_deg,longitude_deg,altitude_m,yaw_deg,pitch_deg,roll_deg,hfov_deg,utc\n"
      "0,42,-71,100,0,-60,0,50,2024-05-01T12:00:00Z\n10,42,-71,200,0,-60,0,50,2024-05-01T12:00:10Z\n"));
  TelemetryOptions options;
  options.max_gap_s = 20;
  CameraStates cameras =
      CameraStates::Load("video.mp4", VideoInfo{}, path, options, "no place", [](const std::string&) {}).value();
  const std::int64_t start_utc_us = cameras.start_utc_us().value();
  EXPECT_NEAR(cameras.At(5)->place.altitude_m, 150, 1e-6);
  cameras.ShiftClock(-2);  // it was late
  EXPECT_NEAR(cameras.At(5)->place.altitude_m, 170, 1e-6);
  EXPECT_FALSE(cameras.At(9));
  EXPECT_EQ(cameras.start_utc_us(), start_utc_us + 2'000'000);
}

TEST(ClockSigma, IsThatOfTheEstimateOrTheGivenOne) {
  EXPECT_EQ(ClockSigma({.offset_s = -1.703, .sigma_s = 0.007}, 2), 0.007) << "corrected";
  EXPECT_DOUBLE_EQ(ClockSigma({.offset_s = 0.04, .sigma_s = 0.03}, 2), 0.05) << "not corrected: the offset remains";
  EXPECT_EQ(ClockSigma({.status = TimeOffsetStatus::kUncertain, .sigma_s = 40}, 2), 2);
}

TEST(UnknownClock, IsSaidWithWhatItMeansForPlaces) {
  std::vector<CameraState> states;
  const TangentPlane plane({RadiansFromDegrees(48), RadiansFromDegrees(11), 100});
  for (int i = 0; i < 5; ++i) states.push_back({.time_s = 0.1 * i, .place = plane.GeodeticFromEnu({1.2 * i, 0, 0})});
  const TimeOffset unknown{.status = TimeOffsetStatus::kUncertain, .sigma_s = 40};
  const ClockPrior prior{.sigma_s = 2};
  const auto line = DescribeUnknownClock(unknown, states, prior);
  ASSERT_TRUE(line);
  EXPECT_TRUE(line->contains("the camera's motion changes too little")) << *line;
  EXPECT_TRUE(line->contains("by 12.0 m")) << *line;
  EXPECT_TRUE(line->contains("contain 2.0 s")) << *line;
  EXPECT_FALSE(DescribeUnknownClock(unknown, states, {})) << "the user says that it is exact";
  EXPECT_FALSE(DescribeUnknownClock({.offset_s = 0.001, .sigma_s = 0.01}, states, prior)) << "known";
  EXPECT_TRUE(DescribeUnknownClock({.status = TimeOffsetStatus::kFewPairs}, states, prior)) << "a short video";
  EXPECT_FALSE(DescribeUnknownClock({.status = TimeOffsetStatus::kNoAttitude}, states, prior)) << "no places";
  const auto apart = DescribeUnknownClock(unknown, states, {.extent = TelemetryExtent::kOther, .sigma_s = 2}).value();
  EXPECT_TRUE(apart.contains("recorded apart from the video: it covers 0.0 to 0.4 s")) << apart;
  EXPECT_TRUE(apart.contains("telemetry.clock_sigma_apart_s")) << apart;
  const auto displaced =
      DescribeUnknownClock(unknown, states, {.extent = TelemetryExtent::kDisplaced, .offset_s = -1.7, .sigma_s = 0.3})
          .value();
  EXPECT_TRUE(displaced.contains("its clock is 1.70 s late if both begin together: -1.70 s are added")) << displaced;
  for (CameraState& state : states) state.place = states[0].place;
  EXPECT_FALSE(DescribeUnknownClock(unknown, states, prior)) << "hovering";
}

TEST(Contradiction, IsSaidInNumbers) {
  EXPECT_FALSE(DescribeContradiction({.status = TimeOffsetStatus::kUncertain}));
  const TimeOffset offset{.status = TimeOffsetStatus::kUncertain,
                          .contradicted = ContradictedMotion{{-2, 4, 31}, {60, -3, -1}}};
  const auto line = DescribeContradiction(offset);
  ASSERT_TRUE(line);
  EXPECT_TRUE(line->contains("contradicts the image, as that of another flight or wrong gimbal angles do")) << *line;
  EXPECT_TRUE(line->contains("2 px/s left, 4 down and 31 px/s clockwise")) << *line;
  EXPECT_TRUE(line->contains("60 px/s right, 3 up and 1 px/s anticlockwise")) << *line;
}

TEST(WrongFieldOfView, IsSaidInNumbers) {
  EXPECT_FALSE(DescribeFieldOfView({.wrong_probability = 0.05, .sigma = 0.02}));
  const auto doubt = DescribeFieldOfView({.wrong_probability = 0.4, .sigma = 0.1});
  ASSERT_TRUE(doubt);
  EXPECT_TRUE(doubt->contains("contain 11 % of the distance")) << *doubt;
  const auto corrected = DescribeFieldOfView({.wrong_probability = 0.9, .log_factor = 0.182, .sigma = 0.05});
  ASSERT_TRUE(corrected);
  EXPECT_TRUE(corrected->contains("20 % too wide")) << *corrected;
  EXPECT_TRUE(corrected->contains("standard error of 5 %")) << *corrected;
  const auto narrow = DescribeFieldOfView({.wrong_probability = 0.9, .log_factor = -0.223, .sigma = 0.05});
  ASSERT_TRUE(narrow);
  EXPECT_TRUE(narrow->contains("20 % too narrow")) << *narrow;
}

TEST(WrongFieldOfView, IsCorrectedInAllStates) {
  const testing::ScratchFolder folder;
  const std::string path = (folder.path() / "telemetry.csv").string();
  ASSERT_TRUE(WriteFileAtomically(path,
                                  "time_s,latitude_deg,longitude_deg,altitude_m,yaw_deg,pitch_deg,roll_deg,hfov_deg\n"
                                  "0,42,-71,100,0,-60,0,50\n1,42,-71,200,0,-60,0,50\n"));
  CameraStates cameras =
      CameraStates::Load("video.mp4", VideoInfo{}, path, {}, "no place", [](const std::string&) {}).value();
  EXPECT_FALSE(cameras.At(0.5)->sigma_focal);
  cameras.CorrectFocalLength(std::log(1.25), 0.05);
  const double focal_before = 1 / std::tan(RadiansFromDegrees(25));
  EXPECT_NEAR(1 / std::tan(*cameras.At(0.5)->hfov_rad / 2), 1.25 * focal_before, 1e-9);
  EXPECT_NEAR(1 / std::tan(*cameras.first_hfov_rad() / 2), 1.25 * focal_before, 1e-9);
  EXPECT_EQ(cameras.At(0.5)->sigma_focal, 0.05);
  ByteWriter writer;
  cameras.Pack(writer);
  const std::vector<std::byte> bytes = writer.Take();
  ByteReader reader(bytes);
  EXPECT_EQ(CameraStates::Unpack(reader).At(0.5)->sigma_focal, 0.05);
}

TEST(WrongYaw, IsSaidInNumbersAndCorrectedInAllStates) {
  const std::string line = DescribeYaw({RadiansFromDegrees(-5.04), RadiansFromDegrees(0.63)});
  EXPECT_TRUE(line.contains("5.0 degrees too small")) << line;
  EXPECT_TRUE(line.contains("standard error of 0.6 degrees")) << line;
  const testing::ScratchFolder folder;
  const std::string path = (folder.path() / "telemetry.csv").string();
  ASSERT_TRUE(WriteFileAtomically(path,
                                  "time_s,latitude_deg,longitude_deg,altitude_m,yaw_deg,pitch_deg,roll_deg,hfov_deg\n"
                                  "0,42,-71,100,358,-60,0,50\n1,42,-71,200,2,-60,0,50\n"));
  CameraStates cameras =
      CameraStates::Load("video.mp4", VideoInfo{}, path, {}, "no place", [](const std::string&) {}).value();
  cameras.CorrectYaw(RadiansFromDegrees(-5));
  EXPECT_NEAR(DegreesFromRadians(cameras.At(0)->attitude->yaw_rad), 3, 1e-6);
  EXPECT_NEAR(DegreesFromRadians(cameras.At(0.5)->attitude->yaw_rad), 5, 1e-6);
}

TEST(WrongYaw, GivenByTheUserStays) {
  EXPECT_FALSE(FindGiven({}).yaw);
  EXPECT_TRUE(FindGiven({.camera_yaw_deg = 90}).yaw);
  EXPECT_TRUE(FindGiven({.hfov_deg = 50}).field_of_view);
}

TEST(ForgottenTelemetry, GivesNoState) {
  const testing::ScratchFolder folder;
  const std::string path = (folder.path() / "telemetry.csv").string();
  ASSERT_TRUE(WriteFileAtomically(
      path,
      "time_s,latitude_deg,longitude_deg,altitude_m,yaw_deg,pitch_deg,roll_deg,hfov_deg,utc\n"
      "0,42,-71,100,0,-60,0,50,2024-05-01T12:00:00Z\n1,42,-71,200,0,-60,0,50,2024-05-01T12:00:01Z\n"));
  CameraStates cameras =
      CameraStates::Load("video.mp4", VideoInfo{}, path, {}, "no place", [](const std::string&) {}).value();
  ASSERT_TRUE(cameras.At(0.5));
  cameras.Forget();
  EXPECT_FALSE(cameras.HasStates());
  EXPECT_FALSE(cameras.At(0.5));
  EXPECT_FALSE(cameras.start_utc_us());
}

TEST(CorrectTelemetry, UnreadableVideoLeavesTelemetryAsItIs) {
  std::vector<std::string> warnings;
  const auto warn = [&](const std::string& warning) { warnings.push_back(warning); };
  CameraStates none;
  EXPECT_TRUE(CorrectTelemetry("absent.mp4", 0.01, {}, CancelToken(), warn, none));
  EXPECT_TRUE(warnings.empty()) << "without telemetry there is nothing to correct";
}

}  // namespace
}  // namespace victorious

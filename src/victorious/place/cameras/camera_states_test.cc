#include "victorious/place/cameras/camera_states.h"

#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/data.h"
#include "victorious/base/file.h"
#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

// A static camera from 0 to 2 s; the last row gives no field of view.
constexpr std::string_view kStateRows =
    "time_s,latitude_deg,longitude_deg,altitude_m,yaw_deg,pitch_deg,roll_deg,hfov_deg\n"
    "0,42,-71,100,0,-60,0,50\n1,42,-71,100,0,-60,0,50\n2,42,-71,100,0,-60,0,\n";

class CameraStatesTest : public ::testing::Test {
 protected:
  Expected<CameraStates> Load(std::string_view rows) {
    const std::string path = (folder_ / "telemetry.csv").string();
    EXPECT_TRUE(WriteFileAtomically(path, rows));
    return CameraStates::Load("video.mp4", VideoInfo{}, path, {}, "no place",
                              [&](const std::string& warning) { warnings_.push_back(warning); });
  }

  testing::ScratchFolder folder_;
  std::vector<std::string> warnings_;
};

TEST_F(CameraStatesTest, WithoutTelemetryGivesNoStates) {
  const CameraStates none;
  EXPECT_FALSE(none.At(0));
  EXPECT_FALSE(none.HasStates());
  EXPECT_EQ(none.trajectory(), nullptr);
}

TEST_F(CameraStatesTest, FileGivesStatesWithinItsTimes) {
  const CameraStates cameras = Load(kStateRows).value();
  EXPECT_TRUE(cameras.HasStates());
  EXPECT_TRUE(cameras.At(0.5));
  EXPECT_FALSE(cameras.At(9));
  EXPECT_NEAR(cameras.first_hfov_rad().value(), RadiansFromDegrees(50), 1e-9);
  EXPECT_FALSE(cameras.start_utc_us());
}

TEST_F(CameraStatesTest, FallbackFieldOfViewAppliesToFramesWithoutOne) {
  CameraStates cameras = Load(kStateRows).value();
  cameras.SetFallbackFieldOfView(0.3);
  EXPECT_NEAR(*cameras.At(0.5)->hfov_rad, RadiansFromDegrees(50), 1e-9);
  EXPECT_EQ(cameras.At(2)->hfov_rad, 0.3);
  const std::optional<CameraState> beyond = cameras.At(9);
  ASSERT_TRUE(beyond);
  EXPECT_EQ(beyond->hfov_rad, 0.3);
  EXPECT_FALSE(beyond->attitude);
}

// 10 m/s to the north, turning by 0.1 rad/s to the right.
TEST_F(CameraStatesTest, AnErrorOfTheClockMovesAndTurnsTheCamera) {
  std::string rows = "time_s,latitude_deg,longitude_deg,altitude_m,yaw_deg,pitch_deg,roll_deg,hfov_deg\n";
  for (int i = 0; i <= 40; ++i) {
    rows += fmt::format("{},{:.9f},11,100,{:.6f},-60,0,50\n", 0.1 * i, 48 + DegreesFromRadians(i / 6.3667e6),
                        DegreesFromRadians(0.01 * i));
  }
  CameraStates cameras = Load(rows).value();
  EXPECT_FALSE(cameras.At(2)->clock_error);
  EXPECT_EQ(cameras.clock_prior().sigma_s, TelemetryOptions{}.clock_sigma_s);
  cameras.SetClockSigma(0.5);
  for (const double time_s : {0.0, 2.0, 4.0}) {
    const ClockError error = cameras.At(time_s)->clock_error.value();
    EXPECT_NEAR((error.moved_enu_m - Eigen::Vector3d(0, 5, 0)).norm(), 0, 0.05) << time_s;
    EXPECT_NEAR((error.turned_enu_rad - Eigen::Vector3d(0, 0, -0.05)).norm(), 0, 1e-4) << time_s;
  }
  CameraStates hovering = Load(kStateRows).value();
  hovering.SetClockSigma(0.5);
  EXPECT_FALSE(hovering.At(1)->clock_error);
}

// Looking 60 degrees below the horizon.
TEST_F(CameraStatesTest, HeightIsAboveTheGivenGroundOrTheEstimate) {
  CameraStates cameras = Load(kStateRows).value();
  EXPECT_FALSE(cameras.HeightAboveGround(cameras.At(0.5), nullptr)) << "unknown";
  cameras.SetGroundHeight(GroundHeight{.height_m = 40, .sigma_m = 1});
  ByteWriter writer;
  cameras.Between(0, 1).Pack(writer);
  const std::vector<std::byte> bytes = writer.Take();
  ByteReader reader(bytes);
  const CameraStates part = CameraStates::Unpack(reader);
  EXPECT_FALSE(reader.HasFailed());
  EXPECT_EQ(part.ground_height(), cameras.ground_height());
  EXPECT_NEAR(part.HeightAboveGround(part.At(0.5), nullptr).value(), 60, 1e-6);
  const FlatGround given(10);
  EXPECT_NEAR(part.HeightAboveGround(part.At(0.5), &given).value(), 90, 0.01);
  const FlatGround above_camera(120);
  EXPECT_FALSE(part.HeightAboveGround(part.At(0.5), &above_camera));
  EXPECT_FALSE(part.HeightAboveGround(part.At(9), &given)) << "no camera";
  cameras.SetFallbackFieldOfView(0.3);
  EXPECT_FALSE(cameras.HeightAboveGround(cameras.At(9), nullptr)) << "a field of view is no place";
  std::optional<CameraState> other_datum = part.At(0.5);
  other_datum->datum = VerticalDatum::kTakeoff;
  EXPECT_FALSE(part.HeightAboveGround(other_datum, nullptr));
  EXPECT_FALSE(part.HeightAboveGround(other_datum, &given));
  cameras.Forget();
  EXPECT_FALSE(cameras.ground_height());
}

// What a segment of a video is given.
TEST_F(CameraStatesTest, PartHasTheSameStates) {
  std::string rows(kStateRows.substr(0, kStateRows.find('\n') + 1));
  for (int i = 0; i < 200; ++i) {
    if (i >= 80 && i < 120) continue;  // a gap of 20 s
    rows += fmt::format("{},{},-71,{},{},-60,0,{}\n", 0.5 * i, 42 + 1e-5 * i, 100 + i % 7, i % 30, i < 150 ? 50 : 40);
  }
  CameraStates cameras = Load(rows).value();
  cameras.SetClockSigma(0.3);
  for (const auto& [from_s, to_s] : {std::pair(0.0, 3.0), {20.2, 31.7}, {38.0, 45.0}, {45.0, 55.0}, {99.0, 120.0}}) {
    const CameraStates part = cameras.Between(from_s, to_s);
    EXPECT_LT(part.trajectory()->states().size(), 50U);
    EXPECT_EQ(part.first_hfov_rad(), cameras.first_hfov_rad());
    for (double time_s = from_s; time_s <= to_s; time_s += 0.07) {
      const auto expected = cameras.At(time_s);
      const auto got = part.At(time_s);
      ASSERT_EQ(got.has_value(), expected.has_value()) << time_s;
      if (!got) continue;
      EXPECT_EQ(got->place.latitude_rad, expected->place.latitude_rad);
      EXPECT_EQ(got->place.altitude_m, expected->place.altitude_m);
      EXPECT_EQ(got->attitude->yaw_rad, expected->attitude->yaw_rad);
      EXPECT_EQ(got->hfov_rad, expected->hfov_rad);
      ASSERT_EQ(got->clock_error.has_value(), expected->clock_error.has_value());
      if (!got->clock_error) continue;
      EXPECT_EQ(got->clock_error->moved_enu_m, expected->clock_error->moved_enu_m);
    }
  }
  EXPECT_FALSE(CameraStates().Between(0, 1).HasStates());
}

TEST_F(CameraStatesTest, OnlyLiveSourcesWithADataStreamNeedPackets) {
  VideoInfo info;
  info.live = true;
  EXPECT_EQ(CameraStates::ForLive(info, {}).packet_receiver(), nullptr);
  info.streams.push_back({.index = 1, .type = StreamType::kData, .codec = "klv"});
  CameraStates live = CameraStates::ForLive(info, {});
  ASSERT_NE(live.packet_receiver(), nullptr);
  EXPECT_FALSE(live.packet_receiver()->IsReady(3, 3.5));
  EXPECT_TRUE(live.packet_receiver()->IsReady(3, 3 + kMaxLiveWait_s));
  info.live = false;
  EXPECT_EQ(CameraStates::ForLive(info, {}).packet_receiver(), nullptr);
}

TEST(AssumedAttitudes, AreForTheSearchOnly) {
  CameraStates cameras;
  EXPECT_FALSE(cameras.ForSearch(0.5));
  cameras.SetAssumedAttitudes({{.time_s = 0, .attitude = Attitude{0, -0.5, 0}, .hfov_rad = 0.5},
                               {.time_s = 1, .attitude = Attitude{0.2, -0.5, 0}, .hfov_rad = 0.5}});
  EXPECT_FALSE(cameras.At(0.5)) << "nothing gets a place";
  ASSERT_TRUE(cameras.ForSearch(0.5));
  EXPECT_NEAR(cameras.ForSearch(0.5)->attitude->yaw_rad, 0.1, 1e-3);
  ByteWriter writer;
  cameras.Pack(writer);
  const std::vector<std::byte> bytes = writer.Take();
  ByteReader reader(bytes);
  const CameraStates read = CameraStates::Unpack(reader);
  EXPECT_TRUE(read.has_assumed_attitudes());
  EXPECT_EQ(read.ForSearch(0.5)->attitude->yaw_rad, cameras.ForSearch(0.5)->attitude->yaw_rad);
  cameras.SetAssumedAttitudes({});
  EXPECT_FALSE(cameras.ForSearch(0.5));
}

}  // namespace
}  // namespace victorious

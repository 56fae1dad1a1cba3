#include "victorious/place/cameras/live_cameras.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/klv_tools.h"
#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

using testing::BigEndian;
using testing::CameraPacket;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::St0601Packet;

constexpr std::uint64_t kStart_us = 1'700'000'000'000'000;

DataPacket Packet(const std::string& text, std::optional<double> time_s, int stream = 1) {
  const Bytes bytes = AsBytes(text);
  return {.stream = stream, .kind = DataKind::kKlv, .time_s = time_s, .bytes = {bytes.begin(), bytes.end()}};
}

DataPacket CameraAt(double time_s, int stream = 1) {
  return Packet(CameraPacket(kStart_us + static_cast<std::uint64_t>(time_s * 1e6)), time_s, stream);
}

TEST(LiveCameraTrack, StateIsKnownOnceALaterPacketArrived) {
  LiveCameraTrack cameras({});
  ASSERT_TRUE(cameras.Add({CameraAt(0)}, 0));
  EXPECT_FALSE(cameras.Covers(0.5));
  EXPECT_FALSE(cameras.At(0.5));
  ASSERT_TRUE(cameras.Add({CameraAt(1)}, 1));
  EXPECT_TRUE(cameras.Covers(0.5));
  const std::optional<CameraState> state = cameras.At(0.5);
  ASSERT_TRUE(state);
  EXPECT_NEAR(DegreesFromRadians(state->place.latitude_rad), 42, 1e-6);
  EXPECT_THAT(cameras.Warnings(), IsEmpty());
}

TEST(LiveCameraTrack, FramesDoNotWaitForStatesThatNeverCome) {
  LiveCameraTrack cameras({});
  ASSERT_TRUE(cameras.Add({}, 10));
  EXPECT_FALSE(cameras.IsReady(10, 10.5));
  EXPECT_TRUE(cameras.IsReady(10, 10 + kMaxLiveWait_s));
  EXPECT_TRUE(cameras.IsReady(10 + kMaxFirstStateWait_s, 10 + kMaxFirstStateWait_s));
  ASSERT_TRUE(cameras.Add({CameraAt(15)}, 15));
  EXPECT_FALSE(cameras.IsReady(15.5, 15.5)) << "the source sends states after all";
}

TEST(LiveCameraTrack, PacketWithoutTimeHasItsArrivalTime) {
  LiveCameraTrack cameras({});
  ASSERT_TRUE(cameras.Add({Packet(CameraPacket(kStart_us), std::nullopt)}, 3));
  EXPECT_TRUE(cameras.At(3.05));
  EXPECT_FALSE(cameras.At(0));
}

TEST(LiveCameraTrack, UsesTheFirstStreamWithCameraStates) {
  LiveCameraTrack cameras({});
  const std::string other = St0601Packet({{2, BigEndian(kStart_us, 8)}});
  ASSERT_TRUE(cameras.Add({Packet(other, 0.0, 1), CameraAt(0, 2)}, 0));
  ASSERT_TRUE(cameras.Add({CameraAt(0.5, 3), CameraAt(0.6, 2)}, 1));
  EXPECT_TRUE(cameras.Covers(0.6));
  EXPECT_FALSE(cameras.Covers(0.61));
}

TEST(LiveCameraTrack, KeepsTheLastSecondsOnly) {
  LiveCameraTrack cameras({});
  for (int second = 0; second <= 100; ++second) ASSERT_TRUE(cameras.Add({CameraAt(second)}, second));
  EXPECT_TRUE(cameras.At(80));
  EXPECT_FALSE(cameras.At(60));
}

TEST(LiveCameraTrack, ItemsHoldFromPacketsThatCameBefore) {
  LiveCameraTrack cameras({});
  // As a producer that sends the field of view once, and the rest in each packet.
  const auto packet = [](double time_s, bool has_field) {
    const auto signed_of = [](double value, double range) {
      return BigEndian(static_cast<std::uint32_t>(static_cast<std::int32_t>(value / range * 2147483647)), 4);
    };
    std::vector<std::pair<int, std::string>> items = {
        {2, BigEndian(kStart_us + static_cast<std::uint64_t>(time_s * 1e6), 8)},
        {5, BigEndian(16384, 2)},
        {13, signed_of(42, 90)},
        {14, signed_of(-71, 180)},
        {18, BigEndian(0, 4)},
        {19, signed_of(-45, 180)},
        {75, BigEndian(6257, 2)},
        {90, BigEndian(0, 4)},
        {91, BigEndian(0, 4)}};
    if (has_field) items.insert(items.begin() + 2, {16, BigEndian(5461, 2)});
    return Packet(St0601Packet(items), time_s);
  };
  for (int i = 0; i <= 20; ++i) ASSERT_TRUE(cameras.Add({packet(0.5 * i, i == 0)}, 0.5 * i));
  const std::optional<CameraState> state = cameras.At(9.75);
  ASSERT_TRUE(state);
  ASSERT_TRUE(state->hfov_rad);
  EXPECT_NEAR(DegreesFromRadians(*state->hfov_rad), 15, 0.1);
  EXPECT_LE(cameras.Warnings().size(), 1U) << "the same warning with other numbers is one";
}

TEST(LiveCameraTrack, WarnsIfNoStreamHasCameraStates) {
  LiveCameraTrack cameras({});
  ASSERT_TRUE(cameras.Add({Packet("no KLV at all", 0.0)}, 0));
  EXPECT_THAT(cameras.Warnings().back(), HasSubstr("objects get no place"));
}

}  // namespace
}  // namespace victorious

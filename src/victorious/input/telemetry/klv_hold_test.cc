#include "victorious/input/telemetry/klv_hold.h"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/klv_tools.h"
#include "victorious/geometry/angles.h"
#include "victorious/input/telemetry/telemetry.h"

namespace victorious {
namespace {

using testing::BigEndian;
using ::testing::Contains;
using ::testing::HasSubstr;
using testing::St0601Packet;

using Items = std::vector<std::pair<int, std::string>>;

std::string Signed(double value, double range) {
  return BigEndian(static_cast<std::uint32_t>(static_cast<std::int32_t>(value / range * 2147483647)), 4);
}

Items Position(double latitude_deg, double longitude_deg = -71) {
  return {{13, Signed(latitude_deg, 90)}, {14, Signed(longitude_deg, 180)}, {75, BigEndian(6257, 2)}};
}

Items Pointing(double heading_deg) {
  return {{5, BigEndian(static_cast<std::uint64_t>(std::lround(heading_deg / 360 * 65535)), 2)},
          {18, BigEndian(0, 4)},
          {19, Signed(-45, 180)},
          {90, BigEndian(0, 4)},
          {91, BigEndian(0, 4)}};
}

Items FieldOfView(double degrees) {
  return {{16, BigEndian(static_cast<std::uint64_t>(std::lround(degrees / 180 * 65535)), 2)}};
}

// A packet `seconds` after the first.
std::string HeldAt(double seconds, const std::vector<Items>& groups) {
  Items items = {{2, BigEndian(static_cast<std::uint64_t>(std::llround(1e6 * (1000 + seconds))), 8)}};
  for (const Items& group : groups) items.insert(items.end(), group.begin(), group.end());
  return St0601Packet(items);
}

Telemetry Parse(const std::string& packets) { return ParseTelemetry(packets, {}).value(); }

TEST(KlvHold, AFieldOfViewThatIsSentOnceHolds) {
  std::string packets = HeldAt(0, {Position(42), Pointing(90), FieldOfView(15)});
  for (int i = 1; i < 40; ++i) packets += HeldAt(i, {Position(42), Pointing(90)});
  const Telemetry telemetry = Parse(packets);
  ASSERT_EQ(telemetry.states.size(), 40U);
  EXPECT_NEAR(DegreesFromRadians(telemetry.states[30].hfov_rad.value_or(0)), 15, 0.01);
  EXPECT_FALSE(telemetry.states[31].hfov_rad) << "30 s later a producer must have repeated it";
  EXPECT_THAT(telemetry.warnings, Contains(HasSubstr("9 of 40 camera states have no field of view")));
}

TEST(KlvHold, AWithdrawnValueDoesNotHold) {
  const std::string packets =
      HeldAt(0, {Position(42), Pointing(90), FieldOfView(15)}) + HeldAt(1, {Position(42), Pointing(90), {{16, ""}}}) +
      HeldAt(2, {Position(42), Pointing(90)}) + HeldAt(3, {Position(42), Pointing(90), FieldOfView(20)}) +
      HeldAt(4, {Position(42), Pointing(90)});
  const Telemetry telemetry = Parse(packets);
  ASSERT_EQ(telemetry.states.size(), 5U);
  EXPECT_FALSE(telemetry.states[1].hfov_rad);
  EXPECT_FALSE(telemetry.states[2].hfov_rad);
  EXPECT_NEAR(DegreesFromRadians(telemetry.states[4].hfov_rad.value_or(0)), 20, 0.01);
}

TEST(KlvHold, PacketsOfOneStreamCompleteEachOther) {
  std::string packets;
  for (int i = 0; i < 10; ++i) {
    packets += HeldAt(0.1 * i, {i % 2 == 0 ? Position(42 + 1e-5 * i) : Pointing(358 + i)});
  }
  const Telemetry telemetry = Parse(packets);
  ASSERT_EQ(telemetry.states.size(), 10U);
  EXPECT_NEAR(DegreesFromRadians(telemetry.states[3].place.latitude_rad), 42 + 3e-5, 1e-7) << "interpolated";
  EXPECT_NEAR(std::remainder(DegreesFromRadians(telemetry.states[2].attitude->yaw_rad), 360), 0, 0.01)
      << "across north: 359 and 1";
  EXPECT_FALSE(telemetry.states[3].sigma_position_m);
}

TEST(KlvHold, AnOldPositionHasALargerError) {
  std::string packets;
  for (int i = 0; i < 5; ++i) packets += HeldAt(i, {Position(42 + 9e-5 * i), Pointing(90), FieldOfView(15)});
  for (int i = 5; i < 20; ++i) packets += HeldAt(i, {Pointing(90), FieldOfView(15)});
  const Telemetry telemetry = Parse(packets);
  ASSERT_EQ(telemetry.states.size(), 20U);
  EXPECT_FALSE(telemetry.states[4].sigma_position_m);
  EXPECT_NEAR(telemetry.states[14].sigma_position_m.value_or(0), 100, 3) << "10 m/s for 10 s";
  EXPECT_FALSE(telemetry.states[14].sigma_attitude_rad);
}

TEST(KlvHold, APacketKeepsItsOwnHeight) {
  const Items above_sea = {{15, BigEndian(10000, 2)}};
  const Items place = {{13, Signed(42, 90)}, {14, Signed(-71, 180)}};
  const std::string packets = HeldAt(0, {Position(42), Pointing(90)}) + HeldAt(0.1, {place, above_sea, Pointing(90)}) +
                              HeldAt(0.2, {place, Pointing(90)});
  const Telemetry telemetry = Parse(packets);
  ASSERT_EQ(telemetry.states.size(), 3U);
  EXPECT_NEAR(telemetry.states[0].place.altitude_m, 1000, 1);
  EXPECT_GT(telemetry.states[1].place.altitude_m, 2000) << "an older height above the ellipsoid does not replace it";
  EXPECT_GT(telemetry.states[2].place.altitude_m, 2000) << "the height that was sent last";
}

TEST(KlvHold, PacketsWithoutAStateAreCounted) {
  std::string packets = HeldAt(0, {Position(42)}) + HeldAt(60, {Position(42), Pointing(90)});
  const Telemetry telemetry = Parse(packets);
  ASSERT_EQ(telemetry.states.size(), 1U);
  EXPECT_THAT(telemetry.warnings, Contains(HasSubstr("1 of 2 KLV packets give no camera state")));
  EXPECT_THAT(telemetry.warnings, Contains(HasSubstr("the platform's heading (item 5) in 1")));
}

}  // namespace
}  // namespace victorious

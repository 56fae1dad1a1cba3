#include "victorious/show/export/vmti_packet.h"

#include <gtest/gtest.h>

#include "victorious/geometry/angles.h"
#include "victorious/input/telemetry/st0601.h"

namespace victorious {
namespace {

// The examples of MISB ST 0903: a height of 10,000 m, an offset of 10 degrees.
TEST(VmtiPacket, MapsRealsAsTheStandardDoes) {
  EXPECT_EQ(HexText(EncodeImapb(10000, -900, 19000, 2)), "2a94");
  EXPECT_EQ(HexText(EncodeImapb(10, -19.2, 19.2, 3)), "3a6667");
  EXPECT_EQ(HexText(EncodeImapb(-90, -90, 90, 4)), "00000000");
}

TEST(VmtiPacket, MappedRealsAreReadBackWithinTheirResolution) {
  for (const double degrees : {-180.0, -179.99999, -5.3, 0.0, 13.4, 180.0}) {
    const std::vector<std::byte> bytes = EncodeImapb(degrees, -180, 180, 4);
    EXPECT_NEAR(ImapbValue(bytes, -180, 180).value(), degrees, 512.0 / (1U << 31U)) << degrees;
  }
  EXPECT_EQ(EncodeImapb(0, -180, 180, 4), EncodeImapb(-0.0, -180, 180, 4));
  EXPECT_EQ(ImapbValue(EncodeImapb(0, -180, 180, 4), -180, 180), 0) << "zero maps to itself";
  EXPECT_EQ(EncodeImapb(1e9, 0, 650, 2), EncodeImapb(650, 0, 650, 2)) << "beyond, the bound";
}

VmtiFrame SmallFrame() {
  Geolocation place;
  place.point = {RadiansFromDegrees(52.1), RadiansFromDegrees(5.3), 13};
  place.covariance_enu_m2 << 4, 1, 0, 1, 1, 0, 0, 0, 0.25;
  return {.utc_us = 1'700'000'000'000'000,
          .frame = 300,
          .width = 640,
          .height = 480,
          .targets = {
              {.id = 200, .box = {10, 20, 20, 30}, .confidence = 0.912, .label = "jeep", .place = std::move(place)}}};
}

// The bytes were made by an encoder written apart, from the standard.
TEST(VmtiPacket, OneTargetByteForByte) {
  EXPECT_EQ(HexText(EncodeVmti(SmallFrame())),
            "060e2b34020b01010e0103010100000068020800060a24181e40004101134a55030a564943544f52494f55530401050501010601"
            "010702012c08020280090201e06532318148010255140202320b03027a9e05015b1116470ccccc2e533333039100400020001060"
            "0040004000660602046a6565700102ed5e");
}

TEST(VmtiPacket, IsAPacketOfSt0601WithANestedSet) {
  VmtiFrame frame = SmallFrame();
  for (int i = 0; i < 30; ++i) frame.targets.push_back({.id = i, .box = {-50, 400, 700, 500}, .label = "a long name"});
  const std::vector<std::byte> bytes = EncodeVmti(frame);
  const KlvUnits units = SplitKlv(bytes);
  ASSERT_EQ(units.units.size(), 1u);
  const KlvPacket packet = DecodeSt0601(units.units.front());
  EXPECT_EQ(packet.problem, "");
  EXPECT_EQ(packet.Number(2), 1.7e15);
  ASSERT_TRUE(packet.checksum);
  EXPECT_TRUE(packet.checksum->IsValid());
  ASSERT_NE(packet.Find(74), nullptr);
  EXPECT_TRUE(packet.Find(74)->is_set);
}

}  // namespace
}  // namespace victorious

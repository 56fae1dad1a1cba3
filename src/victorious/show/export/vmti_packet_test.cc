#include "victorious/show/export/vmti_packet.h"

#include <cmath>

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
            "060e2b34020b01010e010301010000007f020800060a24181e40004101134a6c030a564943544f52494f55530401050501010601"
            "010702012c08020280090201e06549488148010255140202320b03027a9e05015b1116470ccccc2e533333039100400020001060"
            "0040004000661d011575726e3a766963746f72696f75733a6d6f64656c7302046a65657001025d20");
}

KlvPacket Decoded(const VmtiFrame& frame) {
  const std::vector<std::byte> bytes = EncodeVmti(frame);
  const KlvUnits units = SplitKlv(bytes);
  EXPECT_EQ(units.units.size(), 1u);
  return DecodeSt0601(units.units.front());
}

// How many bytes the nested set has.
std::size_t SetSize(const VmtiFrame& frame) {
  const KlvPacket packet = Decoded(frame);
  return std::get<KlvRaw>(packet.Find(74)->value).size();
}

TEST(VmtiPacket, IsAPacketOfSt0601WithANestedSet) {
  VmtiFrame frame = SmallFrame();
  for (int i = 1; i <= 30; ++i) frame.targets.push_back({.id = i, .box = {-50, 400, 700, 500}, .label = "a long name"});
  const KlvPacket packet = Decoded(frame);
  EXPECT_EQ(packet.problem, "");
  EXPECT_EQ(packet.Number(2), 1.7e15);
  ASSERT_TRUE(packet.checksum);
  EXPECT_TRUE(packet.checksum->IsValid());
  ASSERT_NE(packet.Find(74), nullptr);
  EXPECT_TRUE(packet.Find(74)->is_set);
}

TEST(VmtiPacket, BoxesAreClippedAndThoseOutsideLeftOut) {
  VmtiFrame inside = SmallFrame();
  VmtiFrame beyond = inside;
  inside.targets.front().box = {0, 0, 640, 480};
  beyond.targets.front().box = {-30, -10, 900, 700};
  EXPECT_EQ(EncodeVmti(inside), EncodeVmti(beyond));

  VmtiFrame none = inside;
  none.targets.clear();
  for (const Box& box : {Box{-50, 10, 20, 20}, Box{640, 0, 5, 5}, Box{10, 10, 0, 5}, Box{10, 10, NAN, 5}}) {
    beyond.targets.front().box = box;
    EXPECT_EQ(EncodeVmti(beyond), EncodeVmti(none)) << box.x;
  }
  beyond.width = 0;
  EXPECT_EQ(Decoded(beyond).problem, "");
}

TEST(VmtiPacket, ValuesBeyondTheStandardAreLeftOut) {
  VmtiFrame frame = SmallFrame();
  const std::size_t whole = SetSize(frame);
  constexpr std::size_t kErrors = 12;
  constexpr std::size_t kPlace = 2 + 10;  // number, length, latitude, longitude, height
  Geolocation& place = *frame.targets.front().place;
  place.covariance_enu_m2(0, 0) = 1e8;
  EXPECT_EQ(SetSize(frame), whole - kErrors) << "10 km are no 650 m";
  place.covariance_enu_m2(0, 0) = -1e-9;
  EXPECT_EQ(SetSize(frame), whole - kErrors);
  for (const double height_m : {-5000.0, 25000.0, static_cast<double>(NAN)}) {
    place.point.altitude_m = height_m;
    EXPECT_EQ(SetSize(frame), whole - kErrors - kPlace) << height_m;
  }
  frame.targets.front().confidence = NAN;
  EXPECT_EQ(Decoded(frame).problem, "");
  EXPECT_EQ(ImapbValue(EncodeImapb(NAN, 0, 650, 2), 0, 650), std::nullopt);
}

}  // namespace
}  // namespace victorious

#include "victorious/input/telemetry/klv_camera.h"

#include <bit>

#include <gtest/gtest.h>

#include "testing/klv_tools.h"
#include "victorious/geometry/angles.h"
#include "victorious/input/telemetry/klv_packets.h"

namespace victorious {
namespace {

using testing::BerLength;
using testing::BigEndian;
using testing::CameraPacket;
using testing::kEg0104LabelBytes;
using testing::St0601Packet;

KlvPacket Decode(const std::string& text) { return DecodeKlv(AsBytes(text)).packets.at(0); }

std::optional<CameraState> CameraOf(const std::string& text) { return CameraFromKlv(Decode(text)); }

TEST(KlvCamera, PlatformAndSensorRotationsAreComposed) {
  const auto state = CameraOf(CameraPacket(1'000'000));
  ASSERT_TRUE(state);
  EXPECT_NEAR(DegreesFromRadians(state->place.latitude_rad), 42, 1e-6);
  EXPECT_NEAR(DegreesFromRadians(state->place.longitude_rad), -71, 1e-6);
  EXPECT_NEAR(state->place.altitude_m, 1000, 0.2);
  EXPECT_EQ(state->datum, VerticalDatum::kEllipsoid);
  // Heading 90 plus azimuth 90: south, 45 degrees down.
  EXPECT_NEAR(DegreesFromRadians(state->attitude->yaw_rad), 180, 0.01);
  EXPECT_NEAR(DegreesFromRadians(state->attitude->pitch_rad), -45, 0.01);
  EXPECT_NEAR(DegreesFromRadians(state->attitude->roll_rad), 0, 0.01);
  EXPECT_NEAR(DegreesFromRadians(*state->hfov_rad), 30, 0.01);
  EXPECT_EQ(state->utc_us, 1'000'000);
}

TEST(KlvCamera, NoStateWithoutPointingOrPlace) {
  const std::string zero = BigEndian(0, 4);
  const std::string latitude = BigEndian(1002159035, 4);
  EXPECT_FALSE(CameraOf(St0601Packet({{13, latitude}, {14, latitude}, {75, BigEndian(6257, 2)}})));
  const std::vector<std::pair<int, std::string>> pointing = {{5, BigEndian(0, 2)}, {90, zero}, {91, zero}, {18, zero}};
  auto unknown_elevation = pointing;
  unknown_elevation.insert(unknown_elevation.end(), {{13, latitude}, {14, latitude}, {75, BigEndian(6257, 2)}});
  unknown_elevation.emplace_back(19, BigEndian(0x80000000, 4));
  EXPECT_FALSE(CameraOf(St0601Packet(unknown_elevation)));
  auto no_fix = pointing;
  no_fix.insert(no_fix.end(), {{13, zero}, {14, zero}, {75, BigEndian(6257, 2)}, {19, zero}});
  EXPECT_FALSE(CameraOf(St0601Packet(no_fix))) << "GPS receivers write 0, 0 before their first fix";
}

TEST(KlvCamera, NoStateFromABadChecksum) {
  std::string text = CameraPacket(1);
  text.back() = static_cast<char>(text.back() ^ 1);
  EXPECT_FALSE(CameraOf(text));
}

TEST(KlvCamera, Eg0104GivesTheOpticalAxis) {
  const auto item = [](std::uint64_t code, const std::string& value) {
    return std::string("\x06\x0E\x2B\x34\x01\x01\x01\x01", 8) + BigEndian(code, 8) + BerLength(value.size()) + value;
  };
  const auto number = [](float value) { return BigEndian(std::bit_cast<std::uint32_t>(value), 4); };
  const std::string value = item(0x0701020102040200, BigEndian(std::bit_cast<std::uint64_t>(38.16), 8)) +
                            item(0x0701020102060200, BigEndian(std::bit_cast<std::uint64_t>(-77.36), 8)) +
                            item(0x0701020102020000, number(1984.5F)) + item(0x0701100102000000, number(-2.F)) +
                            item(0x0701100103000000, number(-35.F)) + item(0x0420020101080000, number(0.8F));
  const KlvPacket packet = Decode(std::string(kEg0104LabelBytes) + BerLength(value.size()) + value);
  EXPECT_EQ(packet.standard, KlvStandard::kEg0104);
  const auto state = CameraFromKlv(packet);
  ASSERT_TRUE(state);
  EXPECT_EQ(state->datum, VerticalDatum::kEgm96);
  EXPECT_NEAR(DegreesFromRadians(state->attitude->yaw_rad), 358, 1e-6);
  EXPECT_NEAR(DegreesFromRadians(state->attitude->pitch_rad), -35, 1e-6);
  EXPECT_NEAR(DegreesFromRadians(*state->hfov_rad), 0.8, 1e-6);
}

}  // namespace
}  // namespace victorious

#include "victorious/input/telemetry/geoid.h"

#include <bit>
#include <string>

#include <gtest/gtest.h>

#include "testing/klv_tools.h"
#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

using testing::BigEndian;

std::string Number(double value) { return BigEndian(std::bit_cast<std::uint64_t>(value), 8); }

// A global grid in steps of 90 degrees from longitude -180, rows at -90, 0 and 90; heights are 10 row + column.
std::string Grid() {
  std::string text = Number(-90) + Number(-180) + Number(90) + Number(90) + BigEndian(3, 4) + BigEndian(4, 4);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      text += BigEndian(std::bit_cast<std::uint32_t>(static_cast<float>(10 * row + column)), 4);
    }
  }
  return text;
}

double UndulationAt(const Geoid& geoid, double latitude_deg, double longitude_deg) {
  return geoid.UndulationAt(RadiansFromDegrees(latitude_deg), RadiansFromDegrees(longitude_deg)).value_or(-999);
}

TEST(Geoid, InterpolatesBilinearly) {
  const auto geoid = Geoid::Parse(Grid());
  ASSERT_TRUE(geoid) << geoid.error().message;
  EXPECT_NEAR(UndulationAt(*geoid, 0, -180), 10, 1e-6);
  EXPECT_NEAR(UndulationAt(*geoid, 45, -135), 15.5, 1e-6);
  EXPECT_NEAR(UndulationAt(*geoid, 0, 135), 11.5, 1e-6) << "from the last column back to the first";
  EXPECT_NEAR(UndulationAt(*geoid, 90, 0), 22, 1e-6);
}

TEST(Geoid, RefusesInvalidGrids) {
  EXPECT_FALSE(Geoid::Parse(""));
  EXPECT_FALSE(Geoid::Parse(Grid().substr(0, 60)));
  EXPECT_FALSE(Geoid::Parse(std::string(200, 'x')));
}

TEST(Geoid, InstalledEgm96) {
  const auto path = FindEgm96Grid();
  if (!path) GTEST_SKIP() << "SKIPPED: no egm96_15.gtx of PROJ here";
  const auto geoid = Geoid::Read(*path);
  ASSERT_TRUE(geoid) << geoid.error().message;
  EXPECT_NEAR(UndulationAt(*geoid, 0, 0), 17.16, 0.05);
  EXPECT_NEAR(UndulationAt(*geoid, 38.6281550, 269.7791550), -31.628, 0.05);
}

}  // namespace
}  // namespace victorious

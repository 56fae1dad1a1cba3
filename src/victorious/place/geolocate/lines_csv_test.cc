#include "victorious/place/geolocate/lines_csv.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const std::string kHeader = "time_s,latitude_deg,longitude_deg,altitude_m,azimuth_deg,elevation_deg";

TEST(LinesCsv, ReadsColumnsByNameInAnyOrder) {
  const auto table = ParseLinesOfSight(
      "\xEF\xBB\xBFsigma_deg, elevation_deg,azimuth_deg,remark,altitude_m,longitude_deg,latitude_deg,time_s,range_m\r\n"
      "0.5,-30,90,a car,120,-71,42,1.5,240\r\n"
      "\r\n"
      ",-31,91,,121,-71,42,2.5,\r\n",
      "lines.csv");
  ASSERT_TRUE(table) << table.error().message;
  const std::vector<LineOfSight>& lines = table->lines;
  ASSERT_EQ(lines.size(), 2);
  const LineOfSight& first = lines.front();
  EXPECT_EQ(first.time_s, 1.5);
  EXPECT_EQ(first.camera, (GeodeticPoint{RadiansFromDegrees(42), RadiansFromDegrees(-71), 120}));
  EXPECT_DOUBLE_EQ(first.azimuth_rad, kPi / 2);
  EXPECT_DOUBLE_EQ(first.elevation_rad, -kPi / 6);
  EXPECT_EQ(first.range_m, 240);
  EXPECT_DOUBLE_EQ(*first.sigma_rad, RadiansFromDegrees(0.5));
  EXPECT_FALSE(lines.back().range_m);
  EXPECT_FALSE(lines.back().sigma_rad);
}

struct BadCase {
  std::string text;
  std::vector<std::string> words;
};

TEST(LinesCsv, SemicolonsAndCapitals) {
  const auto table = ParseLinesOfSight(
      "Time_s;Latitude_deg;Longitude_deg;Altitude_m;Azimuth_deg;Elevation_deg\n0,5;50;10;100;0;-45,5\n", "x");
  ASSERT_TRUE(table) << table.error().message;
  ASSERT_EQ(table->lines.size(), 1U);
  EXPECT_EQ(table->lines[0].time_s, 0.5);
}

TEST(LinesCsv, ErrorsNameFileLineAndRemedy) {
  const std::string good = "0,42,-71,120,90,-30\n";
  const BadCase cases[] = {
      {"", {"lines.csv: no lines of sight", "header"}},
      {kHeader + "\n", {"lines.csv: no lines of sight"}},
      {"time_s,latitude_deg\n0,1\n", {"lines.csv:1: no column longitude_deg"}},
      {kHeader + ",time_s\n" + good, {"lines.csv:1: column time_s occurs twice"}},
      {kHeader + "\n" + "1,97,-71,120,90,-30\n", {"lines.csv:2: latitude_deg is \"97\"", "from -90 to 90"}},
      {kHeader + "\n" + "nan,42,-71,120,90,-30\n", {"lines.csv:2: time_s is \"nan\"", "a number of s"}},
      {kHeader + "\n" + "1,42,-71,1e999,90,-30\n", {"lines.csv:2: altitude_m"}},
      {kHeader + "\n" + "1,42,-71,120,north,-30\n", {"lines.csv:2: azimuth_deg is \"north\""}},
      {kHeader + "\n" + "1,42,-71,,90,-30\n", {"lines.csv:2: altitude_m is \"\""}},
      {kHeader + "\n" + "1,42,-71\n", {"lines.csv:2: no altitude_m", "after 3 of at least 4"}},
      {kHeader + ",range_m\n0,42,-71,120,90,-30,-5\n", {"lines.csv:2: range_m is \"-5\""}},
      {kHeader + ",sigma_deg\n0,42,-71,120,90,-30,0\n", {"lines.csv:2: sigma_deg is \"0\""}},
  };
  for (const BadCase& bad : cases) {
    const auto lines = ParseLinesOfSight(bad.text, "lines.csv");
    ASSERT_FALSE(lines) << bad.text;
    EXPECT_EQ(lines.error().code, ErrorCode::kInvalidArgument);
    EXPECT_THAT(lines.error().message, Not(HasSubstr("\n")));
    for (const std::string& word : bad.words) EXPECT_THAT(lines.error().message, HasSubstr(word));
  }
}

TEST(LinesCsv, UnreadableRowIsSkippedWithAWarning) {
  const auto table = ParseLinesOfSight(
      "\"time_s\",latitude_deg,longitude_deg,altitude_m,azimuth_deg,elevation_deg\n"
      "0,42,-71,120,90,-30\n1,nan,-71,120,90,-30\n\"2\",42,-71,120,90,-30\n3,42,-7",
      "lines.csv");
  ASSERT_TRUE(table) << table.error().message;
  EXPECT_EQ(table->lines.size(), 2U);
  EXPECT_THAT(table->row_is_valid, ::testing::ElementsAre(true, false, true, false));
  EXPECT_THAT(table->problems,
              ::testing::ElementsAre(HasSubstr("lines.csv:3: latitude_deg is \"nan\""), HasSubstr("lines.csv:5: no")));
}

}  // namespace
}  // namespace victorious

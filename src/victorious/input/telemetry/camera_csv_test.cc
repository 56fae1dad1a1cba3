#include "victorious/input/telemetry/camera_csv.h"

#include <gtest/gtest.h>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

constexpr const char* kHeader = "time_s,latitude_deg,longitude_deg,altitude_m,yaw_deg,pitch_deg,roll_deg,hfov_deg\n";

TEST(CameraCsv, ColumnsByNameInAnyOrder) {
  const auto rows = ParseCameraCsv(
      "\xEF\xBB\xBFlatitude_deg, time_s ,altitude_m,longitude_deg,vertical_datum,extra,sigma_position_m,k1,utc\r\n"
      "42,0.5,100,-71,egm96,x,2,0.1,2026-05-27T13:14:22.5Z\r\n");
  ASSERT_TRUE(rows) << rows.error().message;
  ASSERT_EQ(rows->states.size(), 1U);
  const CameraState& state = rows->states[0];
  EXPECT_EQ(state.time_s, 0.5);
  EXPECT_NEAR(DegreesFromRadians(state.place.longitude_rad), -71, 1e-12);
  EXPECT_EQ(state.datum, VerticalDatum::kEgm96);
  EXPECT_EQ(state.sigma_position_m, 2);
  EXPECT_EQ((*state.distortion)[0], 0.1);
  EXPECT_EQ(state.utc_us, 1779887662500000);
  EXPECT_FALSE(state.attitude);
  EXPECT_FALSE(state.hfov_rad);
}

TEST(CameraCsv, RoundTrips) {
  CameraState full{.time_s = 1.25, .place = {0.7, -1.2, 300}, .datum = VerticalDatum::kTakeoff};
  full.attitude = Attitude{1, -0.5, 0.25};
  full.hfov_rad = 0.5;
  full.sigma_attitude_rad = 0.01;
  full.utc_us = 1'600'000'000'123'456;
  full.distortion = {0.1, -0.2, 0.003, -0.004, 0.05};
  const CameraState bare{.time_s = 2, .place = {0.7, -1.2, 301}};
  const auto rows = ParseCameraCsv(FormatCameraCsv(std::vector{full, bare}));
  ASSERT_TRUE(rows) << rows.error().message;
  ASSERT_EQ(rows->states.size(), 2U);
  const CameraState& again = rows->states[0];
  EXPECT_NEAR(again.place.latitude_rad, 0.7, 1e-11);
  EXPECT_NEAR(again.attitude->pitch_rad, -0.5, 1e-8);
  EXPECT_NEAR(*again.hfov_rad, 0.5, 1e-8);
  EXPECT_NEAR(*again.sigma_attitude_rad, 0.01, 1e-8);
  EXPECT_EQ(again.utc_us, full.utc_us);
  EXPECT_EQ(again.datum, VerticalDatum::kTakeoff);
  EXPECT_EQ(again.distortion, full.distortion);
  EXPECT_FALSE(rows->states[1].attitude);
  EXPECT_FALSE(rows->states[1].distortion);
}

TEST(CameraCsv, BadRowsAreSkippedWithAWarning) {
  const auto rows = ParseCameraCsv(std::string(kHeader) +
                                   "0,42,-71,100,0,-90,0,40\n1,95,-71,100,0,-90,0,40\n"
                                   "2,nan,-71,100,0,-90,0,40\n\n3,42,\n4,42,-71,100,0,-90,0,40");
  ASSERT_TRUE(rows);
  EXPECT_EQ(rows->rows, 5);
  EXPECT_EQ(rows->states.size(), 2U);
  ASSERT_EQ(rows->warnings.size(), 3U);
  EXPECT_EQ(rows->warnings[0], "line 3 is skipped: latitude_deg is \"95\": must be a number from -90 to 90");
  EXPECT_EQ(rows->warnings[2], "line 6 is skipped: longitude_deg is empty");
}

TEST(CameraCsv, SkippedRowsBeyondTheLimitAreCounted) {
  std::string text = std::string(kHeader) + "0,42,-71,100,0,-90,0,40\n";
  for (int i = 0; i < 25; ++i) text += "1,95,-71,100,0,-90,0,40\n";
  const auto rows = ParseCameraCsv(text);
  ASSERT_TRUE(rows);
  ASSERT_EQ(rows->warnings.size(), 21U);
  EXPECT_EQ(rows->warnings.back(), "and 5 more warnings of this kind");
}

TEST(CameraCsv, UnknownHeightRoundTrips) {
  const auto rows = ParseCameraCsv(std::string(kHeader) + "0,42,-71,,0,-90,0,40\n");
  ASSERT_TRUE(rows);
  ASSERT_EQ(rows->states.size(), 1U);
  EXPECT_EQ(rows->states[0].datum, VerticalDatum::kUnknown);
  EXPECT_FALSE(rows->states[0].IsComplete());
  const auto again = ParseCameraCsv(FormatCameraCsv(rows->states, {}, {}));
  ASSERT_TRUE(again);
  EXPECT_EQ(again->states[0].datum, VerticalDatum::kUnknown);
}

TEST(CameraCsv, UtcOffsetsAreApplied) {
  const auto rows = ParseCameraCsv(
      "time_s,latitude_deg,longitude_deg,altitude_m,utc\n0,42,-71,100,2024-01-01T02:00:00+02:00\n"
      "1,42,-71,100,2023-12-31T20:30:01-0330\n2,42,-71,100,yesterday\n");
  ASSERT_TRUE(rows);
  EXPECT_EQ(rows->states[0].utc_us, 1'704'067'200'000'000);
  EXPECT_EQ(rows->states[1].utc_us, 1'704'067'201'000'000);
  EXPECT_FALSE(rows->states[2].utc_us);
  ASSERT_EQ(rows->warnings.size(), 1U);
  EXPECT_NE(rows->warnings[0].find("1 rows"), std::string::npos);
}

// As spreadsheet programs write them in countries with a decimal comma, and other tools.
TEST(CameraCsv, SeparatorsCapitalsAndEncodings) {
  std::string utf16 = "\xFF\xFE";
  for (const char c : std::string_view("time_s,latitude_deg,longitude_deg,altitude_m\n1.5,42.25,-71.5,100\n")) {
    utf16 += std::string{c, '\0'};
  }
  for (const std::string& table :
       {std::string("Time_S,Latitude_Deg,LONGITUDE_DEG,altitude_m\n1.5,42.25,-71.5,100\n"),
        std::string("time_s;latitude_deg;longitude_deg;altitude_m\n1.5;42.25;-71.5;100\n"),
        std::string("time_s;latitude_deg;longitude_deg;altitude_m\r\n1,5;42,25;-71,5;100\r\n"),
        std::string("time_s\tlatitude_deg\tlongitude_deg\taltitude_m\n1.5\t42.25\t-71.5\t100\n"), utf16}) {
    EXPECT_TRUE(LooksLikeCameraCsv(table)) << table;
    const auto rows = ParseCameraCsv(table);
    ASSERT_TRUE(rows) << rows.error().message;
    ASSERT_EQ(rows->states.size(), 1U);
    EXPECT_EQ(rows->states[0].time_s, 1.5);
    EXPECT_NEAR(DegreesFromRadians(rows->states[0].place.longitude_rad), -71.5, 1e-9);
    EXPECT_EQ(rows->states[0].place.altitude_m, 100);
  }
}

TEST(CameraCsv, DecimalCommasBetweenCommasAreNamed) {
  const auto rows = ParseCameraCsv("time_s,latitude_deg,longitude_deg,altitude_m\n1,5,42,25,-71,5,100,0\n");
  ASSERT_FALSE(rows);
  EXPECT_NE(rows.error().message.find("it has 8 cells, the header 4: decimal commas"), std::string::npos)
      << rows.error().message;
}

TEST(CameraCsv, NoUsableRowIsAnError) {
  EXPECT_NE(ParseCameraCsv("time_s,latitude_deg,altitude_m\n1,2,3\n").error().message.find("longitude_deg"),
            std::string::npos);
  EXPECT_FALSE(ParseCameraCsv(kHeader));
  EXPECT_FALSE(ParseCameraCsv(std::string(kHeader) + "a,b,c,d\n"));
}

}  // namespace
}  // namespace victorious

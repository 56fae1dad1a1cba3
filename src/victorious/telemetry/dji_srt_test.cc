#include "victorious/telemetry/dji_srt.h"

#include <gtest/gtest.h>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

void ExpectPlace(const std::optional<CameraState>& state, double latitude_deg, double longitude_deg, double altitude_m,
                 VerticalDatum datum) {
  ASSERT_TRUE(state);
  EXPECT_NEAR(DegreesFromRadians(state->place.latitude_rad), latitude_deg, 1e-9);
  EXPECT_NEAR(DegreesFromRadians(state->place.longitude_rad), longitude_deg, 1e-9);
  EXPECT_NEAR(state->place.altitude_m, altitude_m, 1e-9);
  EXPECT_EQ(state->datum, datum);
}

TEST(DjiSrt, Dialects) {
  ExpectPlace(CameraFromDjiText("[latitude: 41.15] [longitude: 16.41] [rel_alt: 50.7 abs_alt: 172.0]"), 41.15, 16.41,
              172, VerticalDatum::kEgm96);
  ExpectPlace(CameraFromDjiText("[latitude : -20.25] [longtitude : 149.02] [altitude: 213.9]"), -20.25, 149.02, 213.9,
              VerticalDatum::kTakeoff);
  ExpectPlace(CameraFromDjiText("HOME(149.02,-20.25) 2017.08.05 14:11:51\nGPS(149.03,-20.26,16) BAROMETER:1.9"), -20.26,
              149.03, 1.9, VerticalDatum::kTakeoff);
  ExpectPlace(CameraFromDjiText("GPS(-58.4,-34.7,19) Hb:1.5 Hs:1.9"), -34.7, -58.4, 1.5, VerticalDatum::kTakeoff);
  ExpectPlace(CameraFromDjiText("GPS(36.61,-6.11,0.0M) BAROMETER:0.3M"), 36.61, -6.11, 0.3, VerticalDatum::kTakeoff);
  ExpectPlace(CameraFromDjiText("F/5.6, GPS (-58.8, -34.2, 15), HOME (-58.8, -34.2, -57.98m), D 698.70m, H 85.80m"),
              -34.2, -58.8, 85.8, VerticalDatum::kTakeoff);
}

TEST(DjiSrt, OfTwoHeightsTheWantedOneIsTaken) {
  const std::string place = "[latitude: 41.15] [longitude: 16.41] ";
  ExpectPlace(CameraFromDjiText(place + "[rel_alt: 50.7 abs_alt: 172.0]", DjiHeight::kAboveTakeoff), 41.15, 16.41, 50.7,
              VerticalDatum::kTakeoff);
  ExpectPlace(CameraFromDjiText(place + "[abs_alt: 172.0]", DjiHeight::kAboveTakeoff), 41.15, 16.41, 172,
              VerticalDatum::kEgm96);
}

TEST(DjiSrt, GimbalAngles) {
  const auto p4 =
      CameraFromDjiText("GPS (-58.8, -34.2, 15), H 85.80m, F.PRY (2.7°, -7.0°, 110.1°), G.PRY (-24.4°, 0.0°, 110.4°)");
  ASSERT_TRUE(p4 && p4->attitude);
  EXPECT_NEAR(DegreesFromRadians(p4->attitude->yaw_rad), 110.4, 1e-6);
  EXPECT_NEAR(DegreesFromRadians(p4->attitude->pitch_rad), -24.4, 1e-6);
  const auto m300 = CameraFromDjiText(
      "[latitude: 49.1] [longitude: 14.6] [rel_alt: 54.8 abs_alt: 535.4]\n[drone_yaw: -88.3]\n"
      "[gb_yaw: -75.6 gb_pitch: -12.5 gb_roll: 0.0]");
  ASSERT_TRUE(m300 && m300->attitude);
  EXPECT_NEAR(DegreesFromRadians(m300->attitude->yaw_rad), 284.4, 1e-6);
  EXPECT_FALSE(CameraFromDjiText("[latitude: 49.1] [longitude: 14.6] [rel_alt: 1]").value().attitude);
}

TEST(DjiSrt, FieldOfViewFromTheFocalLength) {
  const std::string place = "[latitude: 49.1] [longitude: 14.6] [rel_alt: 1] ";
  EXPECT_NEAR(DegreesFromRadians(*CameraFromDjiText(place + "[focal_len: 24.00]")->hfov_rad), 73.7, 0.1);
  EXPECT_NEAR(DegreesFromRadians(*CameraFromDjiText(place + "[focal_len : 240]")->hfov_rad), 73.7, 0.1);
  EXPECT_NEAR(DegreesFromRadians(*CameraFromDjiText(place + "[focal_len: 24.00] [dzoom: 2.00]")->hfov_rad), 41.1, 0.1);
}

// A tele camera with digital zoom writes millimetres that contain the zoom; older aircraft write whole tenths.
TEST(DjiSrt, FocalLengthsAboveTwoHundredAreTenthsOnlyIfWhole) {
  const std::string place = "[latitude: 49.1] [longitude: 14.6] [rel_alt: 1] ";
  const auto hfov_deg = [&](const std::string& text) {
    return DegreesFromRadians(*CameraFromDjiText(place + text)->hfov_rad);
  };
  EXPECT_NEAR(hfov_deg("[dzoom_ratio: 4.00] [focal_len: 643.30]"), 3.21, 0.01);
  EXPECT_NEAR(hfov_deg("[focal_len: 162.00] [dzoom_ratio: 1.00]"), 12.7, 0.1);
  EXPECT_NEAR(hfov_deg("[focal_len : 280] [dzoom_ratio: 10000, delta:0]"), 65.5, 0.1);
  EXPECT_NEAR(hfov_deg("[focal_len : 280] [dzoom_ratio: 20000, delta:0]"), 35.6, 0.1);
}

TEST(DjiSrt, MissingPlaceIsUnknown) {
  for (const char* text : {"", "GPS(N/A,N/A,3) BAROMETER:0.0", "[latitude: 0.000] [longitude: 0.000] [rel_alt: 0.4]",
                           "[latitude: 91] [longitude: 10]", "GPS(", "GPS(1,2", "[latitude: nan] [longitude: 1]",
                           "[latitude: 48,123,5] [longitude: 11,512] [rel_alt: 10,5]",
                           "[latitude: 48.1 E] [longitude: 11.5 N] [rel_alt: 10]"}) {
    EXPECT_FALSE(CameraFromDjiText(text)) << text;
  }
}

TEST(DjiSrt, DecimalCommas) {
  const auto state =
      CameraFromDjiText("[latitude: -48,125] [longitude: 11,5] [rel_alt: 10,500 abs_alt: 172,250] [focal_len: 240,00]");
  ExpectPlace(state, -48.125, 11.5, 172.25, VerticalDatum::kEgm96);
  EXPECT_NEAR(DegreesFromRadians(*state->hfov_rad), 8.6, 0.1) << "millimetres: it has decimals";
  ExpectPlace(CameraFromDjiText("GPS(11.5,48.1,16) BAROMETER:30,5M"), 48.1, 11.5, 30.5, VerticalDatum::kTakeoff);
}

TEST(DjiSrt, HemisphereAndUnitLetters) {
  ExpectPlace(CameraFromDjiText("[latitude: 48.1 S] [longitude: 11.5 W] [rel_alt: 10]"), -48.1, -11.5, 10,
              VerticalDatum::kTakeoff);
  ExpectPlace(CameraFromDjiText("GPS(48.1000N,11.5000W,12) BAROMETER:100ft"), 48.1, -11.5, 30.48,
              VerticalDatum::kTakeoff);
  ExpectPlace(CameraFromDjiText("GPS (11.5, 48.1, 16), D 8.9ft, H 25.00ft"), 48.1, 11.5, 7.62, VerticalDatum::kTakeoff);
}

TEST(DjiSrt, MissingHeightIsUnknown) {
  for (const char* text :
       {"[latitude: 48.1] [longitude: 11.5]", "[latitude: 48.1] [longitude: 11.5] [rel_alt: n/a abs_alt: nan]",
        "GPS(11.5,48.1,16)", "GPS (11.5, 48.1, 16), D 8.9m"}) {
    ExpectPlace(CameraFromDjiText(text), 48.1, 11.5, 0, VerticalDatum::kUnknown);
  }
}

TEST(DjiSrt, AcceptsAByteOrderMark) {
  EXPECT_EQ(ParseDjiSrt("\xEF\xBB\xBF"
                        "1\n00:00:00,000 --> 00:00:00,033\nGPS(11.5,48.1,16)\n\n")
                .states.size(),
            1U);
}

TEST(DjiSrt, CueTimesAndBlankLinesInCues) {
  const DjiSubtitles subtitles = ParseDjiSrt(
      "1\r\n00:00:00,000 --> 00:00:00,033\r\n[latitude: 49.1] [longitude: 14.6] [rel_alt: 1]\r\n\r\n0\r\n[ct : "
      "5]\r\n\r\n"
      "2\r\n00:01:00,033 --> 00:01:00,066\r\n[latitude: 49.2] [longitude: 14.6] [rel_alt: 1]\r\n\r\n"
      "3\r\n00:01:01,000 --> 00:01:02,000\r\nHOME(1,");
  EXPECT_EQ(subtitles.cues, 3);
  ASSERT_EQ(subtitles.states.size(), 2U);
  EXPECT_EQ(subtitles.states[0].time_s, 0);
  EXPECT_NEAR(subtitles.states[1].time_s, 60.033, 1e-9);
  ASSERT_EQ(subtitles.warnings.size(), 1U);
  EXPECT_NE(subtitles.warnings[0].find("1 of 3"), std::string::npos);
}

TEST(DjiSrt, WithoutCueTimesDatesAreUsed) {
  const DjiSubtitles subtitles = ParseDjiSrt(
      "1\n2017.08.05 14:11:51,393,525,393,525\n[latitude : -20.2] [longtitude : 149.0] [altitude: 9]\n\n"
      "2\n2017.08.05 14:11:52,393,525\n[latitude : -20.2] [longtitude : 149.0] [altitude: 9]\n\n");
  ASSERT_EQ(subtitles.states.size(), 2U);
  EXPECT_NEAR(subtitles.states[1].time_s, 1.0, 1e-6);
  EXPECT_FALSE(subtitles.warnings.empty());
}

}  // namespace
}  // namespace victorious

#include "victorious/input/telemetry/dji_srt.h"

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
  ExpectPlace(CameraFromDjiText(place + "[rel_alt: 50.7 abs_alt: 172.0]", {.height = DjiHeight::kAboveTakeoff}), 41.15,
              16.41, 50.7, VerticalDatum::kTakeoff);
  ExpectPlace(CameraFromDjiText(place + "[abs_alt: 172.0]", {.height = DjiHeight::kAboveTakeoff}), 41.15, 16.41, 172,
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
  EXPECT_EQ(subtitles.warnings[0], "the last subtitle is cut off: it is left out");
}

// Letters before the numbers, longitude first; W and S are negative with or without a sign.
TEST(DjiSrt, AutelWritesLettersFirst) {
  const std::string text =
      "HOME(W: 71.091000, N: 42.363700) 2026-05-27 13:14:22\nGPS(W: 71.090902, N: 42.363691, 86.45m) \nISO:100 "
      "SHUTTER:500\nF.PRY (-1.2°, 0.8°, 96.0°), G.PRY (-53.0°, 2.0°, 23.0°)";
  const auto state = CameraFromDjiText(text);
  ExpectPlace(state, 42.363691, -71.090902, 86.45, VerticalDatum::kTakeoff);
  EXPECT_NEAR(DegreesFromRadians(state->attitude.value().pitch_rad), -53, 1e-6);
  EXPECT_NEAR(DegreesFromRadians(state->attitude.value().yaw_rad), 23, 1e-6);
  EXPECT_TRUE(IsAutelText(text));
  EXPECT_FALSE(IsAutelText("GPS(11.5,48.1,16)"));
  ExpectPlace(CameraFromDjiText("GPS(W: -71.0909, N: 42.3637, 86) ReH:85 "), 42.3637, -71.0909, 85,
              VerticalDatum::kTakeoff);
  ExpectPlace(CameraFromDjiText("GPS(E: 151.2, S: 33.8, 86)"), -33.8, 151.2, 86, VerticalDatum::kTakeoff);
  ExpectPlace(CameraFromDjiText("GPS (N: 42.5, W: 71.5, 12.0m)"), 42.5, -71.5, 12, VerticalDatum::kTakeoff);
}

TEST(DjiSrt, SubtitlesInAss) {
  const DjiSubtitles subtitles = ParseDjiSrt(
      "[Script Info]\nScriptType: v4.00+\n\n[Events]\nFormat: Layer, Start, End, Style, Name, MarginL, MarginR, "
      "MarginV, Effect, Text\nDialogue: 0,0:00:01.50,0:00:02.00,Default,,0,0,0,,HOME(W: 71.0, N: 42.0)\\NGPS(W: 71.1, "
      "N: 42.1, 86) \\NISO:100\nDialogue: 0,0:00:02.50,0:00:03.00,Default,,0,0,0,,HOME(W: 71.0, N: 42.0)\\NGPS(W: "
      "71.2, N: 42.1, 86) \\NISO:100\n");
  ASSERT_EQ(subtitles.states.size(), 2U);
  EXPECT_TRUE(subtitles.is_autel);
  EXPECT_NEAR(subtitles.states[1].time_s, 2.5, 1e-9);
  ExpectPlace(subtitles.states[1], 42.1, -71.2, 86, VerticalDatum::kTakeoff);
}

// A number that ends with the file is not whole.
TEST(DjiSrt, ACutLastCueIsLeftOut) {
  const auto cue = [](int number, const std::string& text) {
    return std::to_string(number) + "\n00:00:0" + std::to_string(number) + ",000 --> 00:00:09,000\n" + text + "\n\n";
  };
  const std::string text = "[latitude: 47.37] [longitude: 8.5567] [rel_alt: 90.4 abs_alt: 547.7] [gb_yaw: 1.0] </font>";
  const std::string whole = cue(1, text) + cue(2, text);
  EXPECT_EQ(ParseDjiSrt(whole).states.size(), 2U);
  EXPECT_EQ(ParseDjiSrt(whole.substr(0, whole.size() - 2)).states.size(), 2U) << "without a line end";
  for (const std::string_view end :
       {"longitude: 8.", "longitude: 8.55", "abs_alt: 54", "[gb_yaw: 1.0", "[gb_yaw: 1.0]"}) {
    const DjiSubtitles cut = ParseDjiSrt(whole.substr(0, whole.rfind(end) + end.size()));
    EXPECT_EQ(cut.states.size(), 1U) << end;
    ASSERT_EQ(cut.warnings.size(), 1U) << end;
    EXPECT_EQ(cut.warnings[0], "the last subtitle is cut off: it is left out");
  }
  const std::string lines = cue(1, text) + cue(2, "[latitude: 47.37] [longitude: 8.5567]\n[gb_yaw: 1.0]");
  EXPECT_EQ(ParseDjiSrt(lines).states.size(), 2U) << "cut between two lines";
  const std::string alone = cue(1, text);
  EXPECT_TRUE(ParseDjiSrt(alone.substr(0, alone.find("567"))).states.empty());
  EXPECT_EQ(
      ParseDjiSrt(cue(1, text) + "2\n00:00:02,000 --> 00:00:09,000\n[latitude: n/a] [longitude: n/a]").states.size(),
      1U);
}

TEST(DjiSrt, OrderOfLatitudeAndLongitude) {
  ExpectPlace(CameraFromDjiText("GPS(139.69,35.69,90.0M)"), 35.69, 139.69, 90, VerticalDatum::kTakeoff);
  ExpectPlace(CameraFromDjiText("GPS(42.36,-71.09,90.0)"), 42.36, -71.09, 90, VerticalDatum::kTakeoff);
  ExpectPlace(CameraFromDjiText("GPS(-71.09,42.36,90.0M)", {.order = GpsOrder::kLongitudeFirst}), 42.36, -71.09, 90,
              VerticalDatum::kTakeoff);
  ExpectPlace(CameraFromDjiText("GPS(42.36,-71.09,16)", {.order = GpsOrder::kLatitudeFirst}), 42.36, -71.09, 0,
              VerticalDatum::kUnknown);
  EXPECT_TRUE(HasAmbiguousGpsOrder("GPS(-71.09,42.36,90.0M)"));
  for (const char* text : {"GPS(139.69,35.69,90.0M)", "GPS(-71.09,42.36,16)", "GPS(W: 71.09, N: 42.36, 90.0m)"}) {
    EXPECT_FALSE(HasAmbiguousGpsOrder(text)) << text;
  }
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

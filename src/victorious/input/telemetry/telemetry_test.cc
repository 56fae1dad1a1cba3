#include "victorious/input/telemetry/telemetry.h"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "testing/data.h"
#include "testing/geoid_grid.h"
#include "testing/klv_tools.h"
#include "victorious/base/file.h"
#include "victorious/geometry/angles.h"
#include "victorious/input/telemetry/telemetry_report.h"

namespace victorious {
namespace {

using testing::BerLength;
using testing::BigEndian;
using testing::CameraPacket;
using ::testing::Contains;
using ::testing::HasSubstr;
using testing::kSt0601LabelBytes;
using testing::St0601Packet;

constexpr const char* kTelemetryHeader = "time_s,latitude_deg,longitude_deg,altitude_m,vertical_datum\n";

DataPacket Packet(int stream, std::optional<double> time_s, const std::string& text) {
  const Bytes bytes = AsBytes(text);
  return {.stream = stream, .kind = DataKind::kKlv, .time_s = time_s, .bytes = {bytes.begin(), bytes.end()}};
}

TEST(Telemetry, BareKlvStartsAtItsFirstPacket) {
  const auto telemetry = ParseTelemetry(CameraPacket(5'000'000) + CameraPacket(5'500'000), {});
  ASSERT_TRUE(telemetry) << telemetry.error().message;
  EXPECT_EQ(telemetry->format, TelemetryFormat::kSt0601);
  ASSERT_EQ(telemetry->states.size(), 2U);
  EXPECT_NEAR(telemetry->states[1].time_s, 0.5, 1e-6);
}

TEST(Telemetry, PacketsOfAVideoUseItsClock) {
  const std::vector packets = {Packet(1, 0.1, CameraPacket(1'000'000)),
                               Packet(1, std::nullopt, CameraPacket(1'500'000)),
                               Packet(1, 1.1, CameraPacket(2'000'000))};
  const auto telemetry = TelemetryFromPackets(packets, {.time_offset_s = 10});
  ASSERT_TRUE(telemetry);
  ASSERT_EQ(telemetry->states.size(), 3U);
  EXPECT_NEAR(telemetry->states[0].time_s, 10.1, 1e-9);
  EXPECT_NEAR(telemetry->states[1].time_s, 10.6, 1e-6)
      << "by its own clock, with the offset of the packets that have both";
}

// ST 0601, item 136: to be added to item 2 for UTC, where item 2 counts without leap seconds (ST 0603).
TEST(Telemetry, LeapSecondsAreAddedToTheTimeStamp) {
  const auto leap_packet = [](std::int32_t leap_s) {
    return St0601Packet({{2, BigEndian(100'500'000, 8)}, {136, BigEndian(static_cast<std::uint32_t>(leap_s), 4)}});
  };
  for (const std::int32_t leap_s : {-28, 28}) {
    const auto telemetry =
        ParseTelemetry(CameraPacket(100'000'000) + leap_packet(leap_s) + CameraPacket(101'000'000), {});
    ASSERT_TRUE(telemetry) << telemetry.error().message;
    ASSERT_GE(telemetry->states.size(), 2U);
    EXPECT_EQ(telemetry->states.front().utc_us, 72'000'000) << leap_s;
    EXPECT_EQ(telemetry->states.back().utc_us, 73'000'000) << leap_s;
    EXPECT_NEAR(telemetry->states.back().time_s, 1, 1e-9) << "the video's clock is not shifted";
    EXPECT_EQ(ToJson(*telemetry)["packets"][0]["utc"], "1970-01-01T00:01:12.000000Z");
    EXPECT_EQ(
        std::ranges::any_of(telemetry->warnings, [](const auto& line) { return line.contains("is taken as -28"); }),
        leap_s > 0);
  }
}

TEST(Telemetry, StreamsAreNotMixed) {
  const std::vector packets = {Packet(1, 0.0, CameraPacket(0)), Packet(2, 0.1, CameraPacket(0)),
                               Packet(2, 0.2, CameraPacket(0))};
  const auto telemetry = TelemetryFromPackets(packets, {});
  ASSERT_TRUE(telemetry);
  EXPECT_EQ(telemetry->states.size(), 2U);
  EXPECT_THAT(telemetry->warnings, Contains(HasSubstr("stream 2")));
}

std::string PlatformPacket(std::uint64_t time_us) {
  return St0601Packet({{2, BigEndian(time_us, 8)}, {5, BigEndian(0, 2)}});
}

// The latitude is item 13: a fraction of 90 degrees in 32 bits.
std::string PositionPacket(double latitude_deg) {
  const auto latitude = static_cast<std::int32_t>(latitude_deg / 90 * 2147483647);
  return St0601Packet({{13, BigEndian(static_cast<std::uint32_t>(latitude), 4)},
                       {14, BigEndian(static_cast<std::uint32_t>(-847062994), 4)},
                       {75, BigEndian(6257, 2)}});
}

std::string PointingPacket() {
  return St0601Packet({{5, BigEndian(16384, 2)},
                       {18, BigEndian(1073741824, 4)},
                       {19, BigEndian(static_cast<std::uint32_t>(-536870912), 4)},
                       {90, BigEndian(0, 4)},
                       {91, BigEndian(0, 4)}});
}

TEST(Telemetry, TheStreamThatHasACameraIsUsed) {
  const std::vector packets = {Packet(1, 0.0, PlatformPacket(0)), Packet(1, 0.1, PlatformPacket(0)),
                               Packet(2, 0.1, CameraPacket(0)), Packet(1, 0.2, PlatformPacket(0))};
  const auto telemetry = TelemetryFromPackets(packets, {});
  ASSERT_TRUE(telemetry);
  ASSERT_EQ(telemetry->states.size(), 1U);
  EXPECT_THAT(telemetry->warnings, Contains(HasSubstr("stream 2 is used")));
}

TEST(Telemetry, StreamsCompleteEachOther) {
  const std::vector packets = {Packet(1, 0.0, PositionPacket(40)), Packet(2, 0.0, PointingPacket()),
                               Packet(2, 0.25, PointingPacket()), Packet(1, 1.0, PositionPacket(41)),
                               Packet(2, 1.0, PointingPacket())};
  const auto telemetry = TelemetryFromPackets(packets, {});
  ASSERT_TRUE(telemetry);
  ASSERT_EQ(telemetry->states.size(), 3U);
  EXPECT_THAT(telemetry->warnings, Contains(HasSubstr("stream 2 is used, completed by 1")));
  EXPECT_NEAR(DegreesFromRadians(telemetry->states[1].place.latitude_rad), 40.25, 1e-6) << "interpolated";
  EXPECT_NEAR(DegreesFromRadians(telemetry->states[1].attitude->pitch_rad), -45, 1e-3);
}

TEST(Telemetry, APacketTooFarInTimeCompletesNothing) {
  const std::vector packets = {Packet(1, 0.0, PositionPacket(40)), Packet(2, 0.0, PointingPacket()),
                               Packet(2, 10.0, PointingPacket())};
  EXPECT_EQ(TelemetryFromPackets(packets, {})->states.size(), 1U);
}

TEST(Telemetry, AnotherCameraCompletesNothing) {
  std::string without_field_of_view = St0601Packet({{5, BigEndian(16384, 2)},
                                                    {13, BigEndian(1002159035, 4)},
                                                    {14, BigEndian(static_cast<std::uint32_t>(-847062994), 4)},
                                                    {18, BigEndian(0, 4)},
                                                    {19, BigEndian(static_cast<std::uint32_t>(-536870912), 4)},
                                                    {75, BigEndian(6257, 2)},
                                                    {90, BigEndian(0, 4)},
                                                    {91, BigEndian(0, 4)}});
  const std::vector packets = {Packet(1, 0.0, CameraPacket(0)), Packet(2, 0.0, without_field_of_view),
                               Packet(2, 0.1, without_field_of_view)};
  const auto telemetry = TelemetryFromPackets(packets, {});
  ASSERT_EQ(telemetry->states.size(), 2U);
  EXPECT_FALSE(telemetry->states[0].hfov_rad);
}

TEST(Telemetry, RepeatedOrDecreasingTimesAreSkipped) {
  const auto telemetry = ParseTelemetry(
      std::string(kTelemetryHeader) + "0,42,-71,1,\n1,42,-71,1,\n1,42,-71,1,\n0.5,42,-71,1,\n2,42,-71,1,\n", {});
  ASSERT_TRUE(telemetry);
  EXPECT_EQ(telemetry->states.size(), 3U);
  EXPECT_THAT(telemetry->warnings, Contains(HasSubstr("2 of 5 camera states")));
}

TEST(Telemetry, PacketsInOneContainerUnitUseTheirOwnClock) {
  const std::vector packets = {Packet(1, 1.0, CameraPacket(5'000'000) + CameraPacket(5'100'000)),
                               Packet(1, 1.2, CameraPacket(5'200'000) + CameraPacket(5'300'000))};
  const auto telemetry = TelemetryFromPackets(packets, {});
  ASSERT_TRUE(telemetry);
  ASSERT_EQ(telemetry->states.size(), 4U);
  EXPECT_NEAR(telemetry->states[1].time_s, 1.1, 1e-6);
  EXPECT_NEAR(telemetry->states[2].time_s, 1.2, 1e-6);
}

TEST(Telemetry, FragmentedPacketIsJoined) {
  const std::string first = CameraPacket(5'000'000);
  const std::string second = CameraPacket(5'100'000);
  const auto cell = [](const std::string& piece) {
    return std::string("\0\1\xDF", 3) + BigEndian(piece.size(), 2) + piece;
  };
  const std::vector bare = {Packet(1, 1.0, first.substr(0, 40)), Packet(1, 1.01, first.substr(40)),
                            Packet(1, 1.1, second.substr(0, 7)), Packet(1, 1.11, second.substr(7))};
  const std::vector cells = {Packet(1, 1.0, cell(first.substr(0, 40))), Packet(1, 1.01, cell(first.substr(40))),
                             Packet(1, 1.1, cell(second))};
  for (const std::vector<DataPacket>& packets : {bare, cells}) {
    const auto telemetry = TelemetryFromPackets(packets, {});
    ASSERT_TRUE(telemetry);
    ASSERT_EQ(telemetry->states.size(), 2U);
    EXPECT_NEAR(telemetry->states[0].time_s, 1.0, 1e-9);
    EXPECT_THAT(telemetry->warnings, ::testing::IsEmpty());
  }
}

TEST(Telemetry, TruncatedPacketIsReported) {
  const std::vector packets = {Packet(1, 1.0, CameraPacket(5'000'000).substr(0, 40)),
                               Packet(1, 1.1, CameraPacket(5'100'000))};
  const auto telemetry = TelemetryFromPackets(packets, {});
  ASSERT_TRUE(telemetry);
  EXPECT_EQ(telemetry->states.size(), 1U);
  EXPECT_THAT(telemetry->warnings, Contains(HasSubstr("stream 1 at 1.00 s: a KLV unit")));
}

TEST(Telemetry, SubtitlesWithoutAPositionAreCounted) {
  DataPacket with{.stream = 1, .kind = DataKind::kSubtitle, .time_s = 0.0, .bytes = {}};
  std::ranges::copy(AsBytes("GPS(11.5,48.1,16)"), std::back_inserter(with.bytes));
  DataPacket without{.stream = 1, .kind = DataKind::kSubtitle, .time_s = 1.0, .bytes = {}};
  std::ranges::copy(AsBytes("GPS(N/A,N/A,3)"), std::back_inserter(without.bytes));
  DataPacket untimed = with;
  untimed.time_s.reset();
  const auto telemetry = TelemetryFromPackets(std::vector{with, without, untimed}, {});
  ASSERT_TRUE(telemetry);
  EXPECT_EQ(telemetry->format, TelemetryFormat::kDjiSubtitles);
  EXPECT_EQ(telemetry->states.size(), 1U);
  EXPECT_THAT(telemetry->warnings, Contains(HasSubstr("1 of 3 subtitles have no position")));
  EXPECT_THAT(telemetry->warnings, Contains(HasSubstr("1 of 3 subtitles have no time")));
}

TEST(Telemetry, SubtitlesOfAnAircraftAllWithoutAPositionAreReported) {
  DataPacket without{.stream = 1, .kind = DataKind::kSubtitle, .time_s = 1.0, .bytes = {}};
  std::ranges::copy(AsBytes("GPS(N/A,N/A,3)"), std::back_inserter(without.bytes));
  DataPacket of_film = without;
  of_film.bytes.clear();
  std::ranges::copy(AsBytes("Where are we?"), std::back_inserter(of_film.bytes));
  const auto telemetry = TelemetryFromPackets(std::vector{without, without}, {});
  ASSERT_TRUE(telemetry);
  EXPECT_EQ(telemetry->format, TelemetryFormat::kDjiSubtitles);
  EXPECT_THAT(telemetry->warnings, Contains(HasSubstr("2 of 2 subtitles have no position")));
  const auto film = TelemetryFromPackets(std::vector{of_film}, {});
  ASSERT_TRUE(film);
  EXPECT_EQ(film->records, 0);
  EXPECT_THAT(film->warnings, ::testing::IsEmpty());
}

TEST(Telemetry, PacketsWithoutTimeAreReported) {
  const auto telemetry = ParseTelemetry(CameraPacket(0) + CameraPacket(0), {});
  ASSERT_TRUE(telemetry);
  EXPECT_TRUE(telemetry->states.empty());
  EXPECT_THAT(telemetry->warnings, Contains(HasSubstr("2 KLV packets have a camera state")));
  EXPECT_THAT(telemetry->warnings, ::testing::Not(Contains(HasSubstr("no packet has"))));
}

TEST(Telemetry, StateWithClockJumpIsSkipped) {
  const auto telemetry = ParseTelemetry(
      std::string(kTelemetryHeader) + "0,42,-71,1,\n1,42,-71,1,\n3601,42,-71,1,\n2,42,-71,1,\n3,42,-71,1,\n", {});
  ASSERT_TRUE(telemetry);
  ASSERT_EQ(telemetry->states.size(), 4U);
  EXPECT_EQ(telemetry->states.back().time_s, 3);
}

TEST(Telemetry, DamagedFirstPacketIsNotTimeZero) {
  std::string damaged = CameraPacket(1'000'000'000);
  damaged.back() = static_cast<char>(damaged.back() + 1);
  const auto telemetry = ParseTelemetry(damaged + CameraPacket(5'000'000) + CameraPacket(5'500'000), {});
  ASSERT_TRUE(telemetry) << telemetry.error().message;
  ASSERT_EQ(telemetry->states.size(), 2U);
  EXPECT_NEAR(telemetry->states[0].time_s, 0, 1e-6);
}

TEST(Telemetry, JumpsAndGapsAreReported) {
  const auto telemetry = ParseTelemetry(std::string(kTelemetryHeader) + "0,42,-71,1,\n1,43,-71,1,\n9,43,-71,1,\n", {});
  ASSERT_TRUE(telemetry);
  EXPECT_THAT(telemetry->warnings, Contains(HasSubstr("jumps 1 time, faster")));
  EXPECT_THAT(telemetry->warnings, Contains(HasSubstr("1 gap of more than 2 s: the camera state is unknown in it")));
}

std::string Cues(const std::vector<std::string>& texts) {
  std::string cues;
  for (std::size_t i = 0; i < texts.size(); ++i) {
    cues += fmt::format("{}\n00:00:{:02},000 --> 00:00:59,000\n{}\n\n", i + 1, i, texts[i]);
  }
  return cues;
}

TEST(Telemetry, AnAssumedOrderOfGpsIsNamedWithItsFlag) {
  const std::string cues = Cues({"GPS(-71.09,42.36,90.0M)", "GPS(-71.09,42.36,90.0M)"});
  EXPECT_THAT(ParseTelemetry(cues, {})->warnings, Contains(HasSubstr("--gps-order longitude_first")));
  const auto turned = ParseTelemetry(cues, {.gps_order = GpsOrder::kLongitudeFirst});
  EXPECT_NEAR(DegreesFromRadians(turned->states[0].place.latitude_rad), 42.36, 1e-9);
  EXPECT_THAT(turned->warnings, ::testing::Not(Contains(HasSubstr("--gps-order"))));
}

TEST(Telemetry, GimbalAnglesThatAreAllZeroArePlaceholders) {
  const auto cue = [](double latitude_deg, double pitch_deg) {
    return fmt::format(
        "[latitude: {:.6f}] [longitude: 8.5] [rel_alt: 90.4 abs_alt: 547.7] [gb_yaw: 0.0 gb_pitch: "
        "{:.1f} gb_roll: 0.0]",
        latitude_deg, pitch_deg);
  };
  const auto flight = ParseTelemetry(Cues({cue(47.37, 0), cue(47.371, 0)}), {.camera_pitch_deg = -90});
  ASSERT_EQ(flight->states.size(), 2U);
  EXPECT_THAT(flight->warnings, Contains(HasSubstr("exactly 0 in all 2 camera states")));
  EXPECT_NEAR(DegreesFromRadians(flight->states[0].attitude.value().pitch_rad), -90, 1e-6) << "the flag applies";
  EXPECT_TRUE(ParseTelemetry(Cues({cue(47.37, 0), cue(47.371, -0.1)}), {})->states[0].attitude);
  EXPECT_TRUE(ParseTelemetry(Cues({cue(47.37, 0), cue(47.37, 0)}), {})->states[0].attitude) << "it does not move";
}

// The 35 mm equivalent means the long side of the sensor.
TEST(Telemetry, OfAnUprightImageTheFocalLengthGivesTheHeight) {
  const std::string cues = Cues({"[latitude: 47.37] [longitude: 8.5] [focal_len: 182.30]"});
  const auto fitted = [&](const TelemetryOptions& options, int width, int height) {
    Telemetry telemetry = ParseTelemetry(cues, options).value();
    FitToImage(width, height, telemetry);
    FitToImage(width, height, telemetry);
    return DegreesFromRadians(telemetry.states[0].hfov_rad.value());
  };
  EXPECT_NEAR(fitted({}, 480, 270), 11.28, 0.01);
  EXPECT_NEAR(fitted({}, 270, 480), 6.36, 0.01);
  EXPECT_NEAR(fitted({.camera_model = "mavic-pro"}, 270, 480), fitted({.camera_model = "mavic-pro"}, 480, 270) * 0.5625,
              0.1);
  EXPECT_NEAR(fitted({.hfov_deg = 6.5}, 270, 480), 6.5, 1e-9) << "as given";
}

TEST(Telemetry, HeightsAboveTakeOffNeedItsHeight) {
  const std::string table = std::string(kTelemetryHeader) + "0,42,-71,30,takeoff\n";
  const auto unknown = ParseTelemetry(table, {});
  ASSERT_TRUE(unknown);
  EXPECT_EQ(unknown->states[0].datum, VerticalDatum::kTakeoff);
  EXPECT_THAT(unknown->warnings, Contains(HasSubstr("--takeoff")));
  const auto known = ParseTelemetry(table, {.takeoff_altitude_m = 12});
  EXPECT_EQ(known->states[0].datum, VerticalDatum::kEllipsoid);
  EXPECT_EQ(known->states[0].place.altitude_m, 42);
  EXPECT_EQ(ParseTelemetry(table, {.vertical_datum = VerticalDatum::kEllipsoid})->states[0].place.altitude_m, 30);
}

TEST(Telemetry, HeightsAboveSeaLevelWithoutGridAreKeptAndReported) {
  const auto telemetry = ParseTelemetry(std::string(kTelemetryHeader) + "0,42,-71,30,egm2008\n", {});
  ASSERT_TRUE(telemetry);
  EXPECT_EQ(telemetry->states[0].datum, VerticalDatum::kEgm2008);
  EXPECT_THAT(telemetry->warnings, Contains(HasSubstr("egm2008")));
}

TEST(Telemetry, InconsistentPointingIsReported) {
  const std::string packet = CameraPacket(0);
  const auto honest = ParseTelemetry(packet, {});
  EXPECT_THAT(honest->warnings, Not(Contains(HasSubstr("disagree"))));
  // The same camera, which looks south, with a frame centre to its north.
  const std::string value = packet.substr(17, packet.size() - 17 - 4);
  const std::string lying = value + "\x17\x04" + BigEndian(1002397655, 4) + "\x18\x04" +
                            BigEndian(static_cast<std::uint32_t>(-847062994), 4) + "\x4E\x02" + BigEndian(2964, 2);
  const auto noticed = ParseTelemetry(std::string(kSt0601LabelBytes) + BerLength(lying.size()) + lying, {});
  ASSERT_TRUE(noticed);
  EXPECT_THAT(noticed->warnings,
              Contains(HasSubstr("point 93.0 degrees (median) away from the recorded frame centre")));
}

TEST(Telemetry, MissingCameraFieldsAreNamed) {
  const auto telemetry = ParseTelemetry(St0601Packet({{5, BigEndian(0, 2)}, {19, BigEndian(0x80000000, 4)}}), {});
  ASSERT_TRUE(telemetry);
  EXPECT_THAT(telemetry->warnings, Contains(HasSubstr("the sensor's elevation (item 19)")));
  EXPECT_THAT(telemetry->warnings, Not(Contains(HasSubstr("heading"))));
}

TEST(Telemetry, InvalidUtf8GivesValidJson) {
  const auto telemetry = ParseTelemetry(std::string(kTelemetryHeader) + "0,\xFF,-71,1,\n1,42,-71,1,\n", {});
  ASSERT_TRUE(telemetry);
  EXPECT_NE(ToJson(*telemetry).dump().find("line 2"), std::string::npos);
}

TEST(Telemetry, NonTelemetryIsRefusedInOneLine) {
  for (const std::string text : {"", "hello", "a,b,c\n1,2,3\n", "\x06\x0E\x2B\x34"}) {
    const auto telemetry = ParseTelemetry(text, {});
    ASSERT_FALSE(telemetry) << text;
    EXPECT_EQ(telemetry.error().message.find('\n'), std::string::npos);
  }
  EXPECT_FALSE(ParseTelemetry(CameraPacket(0), {.vertical_datum = VerticalDatum::kUnknown}));
}

TEST(Telemetry, JsonHasEveryItemByNumberAndName) {
  const auto json = ToJson(*ParseTelemetry(CameraPacket(1'000'000), {}));
  const auto& packet = json["packets"][0];
  EXPECT_EQ(packet["checksum"]["valid"], true);
  EXPECT_EQ(packet["utc"], "1970-01-01T00:00:01.000000Z");
  EXPECT_EQ(packet["items"][1]["number"], 5);
  EXPECT_EQ(packet["items"][1]["name"], "Platform Heading Angle");
  EXPECT_EQ(json["states"].size(), 1U);
}

TEST(Telemetry, TextReportNamesMissingFields) {
  const auto lines = DescribeTelemetry(*ParseTelemetry(std::string(kTelemetryHeader) + "0,42,-71,30,takeoff\n", {}));
  EXPECT_THAT(lines, Contains(HasSubstr("the camera's attitude")));
  EXPECT_THAT(lines, Contains(HasSubstr("field of view")));
  EXPECT_THAT(lines, Contains(HasSubstr("above the ellipsoid")));
  EXPECT_THAT(DescribeTelemetry(*ParseTelemetry(CameraPacket(1), {})), Contains(HasSubstr("geolocation: all")));
}

TEST(Telemetry, TimeOffsetShiftsTheTimes) {
  const auto telemetry = ParseTelemetry(std::string(kTelemetryHeader) + "3,42,-71,1,\n", {.time_offset_s = -1.25});
  ASSERT_TRUE(telemetry);
  EXPECT_EQ(telemetry->states[0].time_s, 1.75);
}

std::string Srt(const std::string& first, const std::string& second) {
  return "1\n00:00:00,000 --> 00:00:01,000\n" + first + "\n\n2\n00:00:01,000 --> 00:00:02,000\n" + second + "\n\n";
}

TEST(Telemetry, SubtitlesWithoutGimbalAnglesTakeTheGivenOnes) {
  // The second position is 11 m farther east.
  const std::string srt =
      Srt("[latitude: 48.0] [longitude: 11.0] [rel_alt: 50]", "[latitude: 48.0] [longitude: 11.00015] [rel_alt: 50]");
  const auto without = ParseTelemetry(srt, {});
  EXPECT_THAT(without->warnings, Contains(HasSubstr("--nadir, or --pitch and --yaw")));
  EXPECT_FALSE(without->states[0].attitude);

  TelemetryOptions options;
  options.camera_pitch_deg = -60;
  options.camera_yaw_deg = 20;
  const auto given = ParseTelemetry(srt, options);
  EXPECT_THAT(given->warnings, Not(Contains(HasSubstr("gimbal"))));
  EXPECT_NEAR(DegreesFromRadians(given->states[0].attitude->pitch_rad), -60, 1e-9);
  EXPECT_NEAR(DegreesFromRadians(given->states[0].attitude->yaw_rad), 20, 1e-9);

  options.camera_yaw_deg.reset();
  const auto by_course = ParseTelemetry(srt, options);
  ASSERT_TRUE(by_course->states[1].attitude) << "the last state has the last course";
  EXPECT_NEAR(DegreesFromRadians(by_course->states[1].attitude->yaw_rad), 90, 0.1);
  EXPECT_GT(by_course->states[0].sigma_attitude_rad, given->states[0].sigma_attitude_rad);
}

// What each dialect lacks, in one line that names the flags; what a pilot then gives makes all states complete.
TEST(Telemetry, OneLineNamesTheFlagsThatSubtitlesLack) {
  const auto check = [](const std::string& text, const std::vector<std::string>& flags, const TelemetryOptions& given) {
    const auto without = ParseTelemetry(Srt(text, text), {});
    std::vector<std::string> lines;
    for (const std::string& line : without->warnings) {
      if (line.starts_with("for places give")) lines.push_back(line);
    }
    ASSERT_EQ(lines.size(), flags.empty() ? 0U : 1U) << text;
    for (const std::string flag : {"--nadir", "--camera", "--takeoff"}) {
      const bool named = !lines.empty() && lines[0].contains(flag);
      EXPECT_EQ(named, std::ranges::find(flags, flag) != flags.end()) << text << flag;
    }
    const auto complete = ParseTelemetry(Srt(text, text), given);
    ASSERT_EQ(complete->states.size(), 2U) << text;
    EXPECT_TRUE(complete->states[0].IsComplete()) << text;
    EXPECT_THAT(complete->warnings, Not(Contains(HasSubstr("for places")))) << text;
  };
  TelemetryOptions options{.takeoff_altitude_m = 500};
  options.camera_pitch_deg = -90;
  options.camera_yaw_deg = 0;
  options.camera_model = "mavic-pro";
  check("HOME(11.0,48.0) 2017.08.05 14:11:51\nGPS(11.0,48.0,16) BAROMETER:51.9", {"--nadir", "--camera", "--takeoff"},
        options);
  check("2022.06.21 16:06:17\nGPS(48.0,11.0,0.0M) BAROMETER:50.3M", {"--nadir", "--camera", "--takeoff"}, options);
  check("[focal_len : 240] [latitude : 48.0] [longtitude : 11.0] [altitude: 57.87]", {"--nadir", "--takeoff"}, options);
  check("GPS (11.0, 48.0, 15), H 85.80m, G.PRY (-24.4, 0.0, 110.4)", {"--camera", "--takeoff"}, options);
  check("[focal_len: 24.00] [latitude: 48.0] [longitude: 11.0] [rel_alt: 43.2] [gb_yaw: 1 gb_pitch: -86 gb_roll: 0]",
        {"--takeoff"}, options);
}

TEST(Telemetry, TheTakeOffsHeightReplacesTheAircraftsHeightAboveTheSea) {
  const std::string text = "[latitude: 53.36] [longitude: 6.46] [rel_alt: 6.0 abs_alt: -122.8]";
  EXPECT_THAT(ParseTelemetry(Srt(text, text), {})->warnings, Contains(HasSubstr("129 m below")));
  const auto given = ParseTelemetry(Srt(text, text), {.takeoff_altitude_m = 42});
  EXPECT_EQ(given->states[0].datum, VerticalDatum::kEllipsoid);
  EXPECT_NEAR(given->states[0].place.altitude_m, 48, 1e-9);
  EXPECT_THAT(given->warnings, Not(Contains(HasSubstr("below"))));
}

TEST(Telemetry, TheCameraGivesTheFieldOfViewOfItsFocalLength) {
  const std::string place = "[latitude: 49.1] [longitude: 14.6] [rel_alt: 90.0] ";
  const auto hfov_deg = [&](const std::string& text, const std::string& camera) {
    TelemetryOptions options;
    options.camera_model = camera;
    const auto telemetry = ParseTelemetry(Srt(place + text, place + text), options);
    return DegreesFromRadians(telemetry->states[0].hfov_rad.value());
  };
  EXPECT_NEAR(hfov_deg("[focal_len: 24.00]", ""), 73.7, 0.1);
  EXPECT_NEAR(hfov_deg("[focal_len: 24.00]", "mavic-3"), 71.6, 0.1) << "a sensor of 4:3";
  EXPECT_NEAR(hfov_deg("[focal_len: 48.00]", "mavic-3"), 39.7, 0.1) << "zoomed";
  EXPECT_NEAR(hfov_deg("", "Mavic Pro"), 66.6, 0.1) << "78.8 degrees by the diagonal";
}

TEST(Telemetry, AHoveringCameraHasNoCourse) {
  const std::string here = "[latitude: 48.0] [longitude: 11.0] [rel_alt: 50]";
  TelemetryOptions options;
  options.camera_pitch_deg = -90;
  EXPECT_THAT(ParseTelemetry(Srt(here, here), options)->warnings, Contains(HasSubstr("give --yaw")));
}

TEST(Telemetry, GimbalAnglesOfTheTelemetryTakePrecedence) {
  const std::string text =
      "[latitude: 49.1] [longitude: 14.6] [rel_alt: 54.8] [gb_yaw: 40 gb_pitch: -12.5 gb_roll: 0.0]";
  TelemetryOptions options;
  options.camera_pitch_deg = -90;
  options.camera_yaw_deg = 0;
  EXPECT_NEAR(DegreesFromRadians(ParseTelemetry(Srt(text, text), options)->states[0].attitude->pitch_rad), -12.5, 1e-6);
}

// What "altitude" alone is above differs from aircraft to aircraft.
TEST(Telemetry, HeightsThatMayBeAboveTheSeaAreReported) {
  const auto read = [](const std::string& first, const std::string& second, const TelemetryOptions& options = {}) {
    const auto text = [](const std::string& height) {
      return "[latitude: 48.0] [longtitude: 11.0] [altitude: " + height + "]";
    };
    return *ParseTelemetry(Srt(text(first), text(second)), options);
  };
  const auto may_be = Contains(AllOf(HasSubstr("altitude, 214 to 220 m"), HasSubstr("--vertical-datum")));
  EXPECT_THAT(read("214.0", "220.1").warnings, may_be);
  EXPECT_EQ(read("214.0", "220.1").states[0].datum, VerticalDatum::kTakeoff);
  EXPECT_THAT(read("0.0", "758.0").warnings, Contains(HasSubstr("taken for heights above the sea"))) << "no fix yet";
  EXPECT_THAT(read("0.3", "57.9").warnings, Not(Contains(HasSubstr("above the sea")))) << "it starts";
  TelemetryOptions given{.vertical_datum = VerticalDatum::kTakeoff};
  EXPECT_THAT(read("214.0", "220.1", given).warnings, Not(Contains(HasSubstr("above the sea"))));
  EXPECT_THAT(read("757.9", "758.0").warnings, Contains(HasSubstr("taken for heights above the sea")));
  EXPECT_NE(read("757.9", "758.0", {.takeoff_altitude_m = 600}).states[0].place.altitude_m, 1357.9);
}

TEST(Telemetry, HeightsThatPutTheTakeOffBelowTheSeaAreReported) {
  const auto warnings = [](const std::string& heights) {
    const std::string text = "[latitude: 49.1] [longitude: 14.6] [" + heights + "]";
    return ParseTelemetry(Srt(text, text), {})->warnings;
  };
  EXPECT_THAT(warnings("rel_alt: 90.0 abs_alt: 12.0"), Contains(HasSubstr("78 m below")));
  EXPECT_THAT(warnings("rel_alt: 90.0 abs_alt: 85.0"), Not(Contains(HasSubstr("below"))));
}

TEST(Telemetry, MaxGapIsTheLongestIntervalWithoutAWarning) {
  const std::string table = std::string(kTelemetryHeader) + "0,42,-71,1,\n3,42,-71,1,\n";
  EXPECT_THAT(ParseTelemetry(table, {.max_gap_s = 2.9})->warnings, Contains(HasSubstr("1 gap of more than 2.9 s")));
  EXPECT_THAT(ParseTelemetry(table, {.max_gap_s = 3.1})->warnings, Not(Contains(HasSubstr("gaps"))));
}

TEST(Telemetry, TheGivenFieldOfViewOverridesThatOfTheTelemetry) {
  const std::string packet = CameraPacket(5'000'000);
  const auto given = ParseTelemetry(packet, {.hfov_deg = 33});
  const auto own = ParseTelemetry(packet, {});
  ASSERT_TRUE(given && own);
  ASSERT_EQ(given->states.size(), 1U);
  EXPECT_NEAR(given->states[0].hfov_rad.value(), RadiansFromDegrees(33), 1e-12);
  ASSERT_EQ(own->states.size(), 1U);
  EXPECT_NE(own->states[0].hfov_rad, given->states[0].hfov_rad);
}

TEST(Telemetry, HeightsAboveTheSeaAreConvertedByTheGivenGeoidGrid) {
  const testing::ScratchFolder folder;
  const std::string grid = (folder.path() / "grid.gtx").string();
  ASSERT_TRUE(WriteFileAtomically(grid, testing::ConstantGeoidGrid(-27.5F)));
  const auto telemetry = ParseTelemetry(std::string(kTelemetryHeader) + "0,42,-71,30,egm2008\n", {.geoid_grid = grid});
  ASSERT_TRUE(telemetry) << telemetry.error().message;
  EXPECT_EQ(telemetry->states[0].datum, VerticalDatum::kEllipsoid);
  EXPECT_NEAR(telemetry->states[0].place.altitude_m, 2.5, 1e-6);
}

}  // namespace
}  // namespace victorious

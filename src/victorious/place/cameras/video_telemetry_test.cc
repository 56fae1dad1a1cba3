// Tests with third-party files of known content.
#include "victorious/place/cameras/video_telemetry.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "testing/data.h"
#include "victorious/base/file.h"
#include "victorious/geometry/angles.h"
#include "victorious/input/telemetry/klv_camera.h"
#include "victorious/input/telemetry/klv_packets.h"
#include "victorious/input/telemetry/telemetry_file.h"
#include "victorious/input/telemetry/telemetry_report.h"

namespace victorious {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Optional;

Telemetry MustRead(const std::filesystem::path& path) {
  auto telemetry = ReadTelemetry(path.string(), {});
  EXPECT_TRUE(telemetry) << telemetry.error().message;
  return telemetry ? *std::move(telemetry) : Telemetry();
}

// Distance in metres from a point to a line of sight, without the component along the line.
double MissOf(const CameraState& state, const GeodeticPoint& point) {
  const Eigen::Vector3d towards = TangentPlane(state.place).EnuFromGeodetic(point);
  return (CameraFromEnu(*state.attitude) * towards).head<2>().norm();
}

GeodeticPoint FrameCentre(const KlvPacket& packet) {
  return {RadiansFromDegrees(packet.Number(23).value_or(0)), RadiansFromDegrees(packet.Number(24).value_or(0)),
          packet.Number(25).value_or(0)};
}

TEST(VideoTelemetry, LineOfSightMatchesRecordedFrameCentre) {
  VICTORIOUS_DATA_OR_SKIP(path, "real/fmv_klv/osh_vrsg/sample-stream.ts");
  const Telemetry telemetry = MustRead(path);
  ASSERT_EQ(telemetry.packets.size(), 277U);
  EXPECT_EQ(telemetry.states.size(), 277U);
  EXPECT_THAT(telemetry.warnings, IsEmpty());
  for (const KlvPacket& packet : telemetry.packets) {
    ASSERT_TRUE(packet.checksum && packet.checksum->IsValid());
    const auto error_rad = ComputeFrameCentreError(packet);
    ASSERT_TRUE(error_rad);
    EXPECT_LT(DegreesFromRadians(*error_rad), 0.005);
    const auto camera = CameraFromKlv(packet);
    ASSERT_TRUE(camera);
    const double range_m = TangentPlane(camera->place).EnuFromGeodetic(FrameCentre(packet)).norm();
    EXPECT_NEAR(range_m, *packet.Number(21), 0.2);
  }
}

// Both heights are above mean sea level, so the geoid cancels.
TEST(VideoTelemetry, StareLinesOfARealFlightIntersect) {
  VICTORIOUS_DATA_OR_SKIP(path, "real/fmv_klv/raw_packets/Cheyenne.bin");
  const Telemetry telemetry = MustRead(path);
  ASSERT_EQ(telemetry.packets.size(), 407U);
  EXPECT_EQ(telemetry.states.size(), 407U);
  for (const auto& [first, last] : {std::pair{15, 120}, {191, 326}}) {
    std::vector<double> misses_m;
    for (int i = first; i <= last; ++i) {
      const KlvPacket& packet = telemetry.packets[static_cast<std::size_t>(i)];
      const auto camera = CameraFromKlv(packet);
      ASSERT_TRUE(camera);
      misses_m.push_back(MissOf(*camera, FrameCentre(packet)));
    }
    std::ranges::nth_element(misses_m, misses_m.begin() + static_cast<std::ptrdiff_t>(misses_m.size() / 2));
    EXPECT_LT(misses_m[misses_m.size() / 2], 15) << "packets " << first << " to " << last << ", 2 to 3 km away";
  }
}

TEST(VideoTelemetry, MatchesReferenceDecoding) {
  VICTORIOUS_DATA_OR_SKIP(path, "real/fmv_klv/raw_packets/DynamicOnlyMISMMSPacketData.bin");
  const Telemetry telemetry = MustRead(path);
  ASSERT_EQ(telemetry.packets.size(), 1U);
  const KlvPacket& packet = telemetry.packets[0];
  EXPECT_TRUE(packet.checksum && packet.checksum->IsValid());
  const std::vector<std::pair<int, double>> expected = {
      {5, 159.974365},    {6, -0.431532},   {7, 3.405866},    {13, 60.176823},  {14, 128.426759},
      {15, 14190.719463}, {16, 144.571298}, {17, 152.643626}, {18, 160.719211}, {19, -168.792325},
      {21, 68590.983299}, {22, 722.819867}, {23, -10.542388}, {24, 29.157890},  {25, 3216.037232}};
  for (const auto& [number, value] : expected) EXPECT_NEAR(packet.Number(number).value_or(NAN), value, 1e-6) << number;
}

TEST(VideoTelemetry, BadChecksumGivesNoCamera) {
  VICTORIOUS_DATA_OR_SKIP(path, "real/fmv_klv/raw_packets/DynamicConstantMISMMSPacketData.bin");
  const Telemetry telemetry = MustRead(path);
  EXPECT_THAT(telemetry.states, IsEmpty());
  EXPECT_THAT(telemetry.warnings, Contains(HasSubstr("1 of 1 KLV packets fail their checksum")));
}

TEST(VideoTelemetry, NonConformingProducerIsReported) {
  VICTORIOUS_DATA_OR_SKIP(path, "real/fmv_klv/raw_packets/DayFlight.klv");
  const Telemetry telemetry = MustRead(path);
  EXPECT_THAT(telemetry.warnings, Contains(HasSubstr("away from the recorded frame centre")));
  const KlvPacket& packet = telemetry.packets.at(0);
  EXPECT_NEAR(*packet.Number(5), 86.10666056305791, 1e-12);
  EXPECT_NEAR(*packet.Number(18), 46.10314941175821, 1e-12);
  EXPECT_NEAR(*packet.Number(22), 69.73, 0.01);
  EXPECT_EQ(PrecisionTime(packet), 1245257585099653);
}

TEST(VideoTelemetry, PlaceholderValuesGiveNoCamera) {
  VICTORIOUS_DATA_OR_SKIP(path, "real/fmv_klv/raw_packets/realflight.bin");
  const Telemetry telemetry = MustRead(path);
  EXPECT_EQ(telemetry.packets.size(), 19U);
  EXPECT_THAT(telemetry.states, IsEmpty());
  EXPECT_THAT(telemetry.warnings, Contains(HasSubstr("the sensor's elevation (item 19)")));
}

TEST(VideoTelemetry, UniversalSetOfEg0104) {
  VICTORIOUS_DATA_OR_SKIP(path, "real/fmv_klv/kwiver_aphill/aphill_klv_10s.ts");
  const Telemetry telemetry = MustRead(path);
  EXPECT_EQ(telemetry.format, TelemetryFormat::kEg0104);
  ASSERT_EQ(telemetry.states.size(), 300U);
  const CameraState& first = telemetry.states[0];
  EXPECT_NEAR(DegreesFromRadians(first.place.latitude_rad), 38.1599, 1e-4);
  EXPECT_NEAR(DegreesFromRadians(first.place.longitude_rad), -77.356, 1e-3);
  EXPECT_NEAR(DegreesFromRadians(*first.hfov_rad), 0.8, 1e-6);
  // The line of sight, at the packet's slant range, ends near the frame centre, 3.4 km away.
  const Eigen::Vector3d end = CameraFromEnu(*first.attitude).conjugate() * Eigen::Vector3d(0, 0, 3430.4);
  const GeodeticPoint met = TangentPlane(first.place).GeodeticFromEnu(end);
  EXPECT_NEAR(DegreesFromRadians(met.latitude_rad), 38.1851, 2e-3);
  EXPECT_NEAR(DegreesFromRadians(met.longitude_rad), -77.3581, 2e-3);
}

TEST(VideoTelemetry, SyntheticStreamAndVideosWithout) {
  VICTORIOUS_DATA_OR_SKIP(folder, "real/fmv_klv/kwiver_synthetic");
  const Telemetry telemetry = MustRead(folder / "h264_klv.ts");
  ASSERT_EQ(telemetry.packets.size(), 30U);
  for (const KlvPacket& packet : telemetry.packets) {
    EXPECT_TRUE(packet.checksum && packet.checksum->IsValid());
    EXPECT_EQ(packet.items.size(), 140U);
    EXPECT_TRUE(packet.problem.empty());
  }
  EXPECT_NEAR(*telemetry.packets[0].Number(104), 23456.234375, 1e-9);
  for (const char* name : {"h264_no_klv.ts", "h264_audio.ts"}) {
    const auto none = ReadTelemetry((folder / name).string(), {});
    ASSERT_FALSE(none);
    EXPECT_THAT(none.error().message, HasSubstr("no telemetry"));
  }
}

TEST(VideoTelemetry, ErrorOfAnotherFileSaysWhatTelemetryIs) {
  const testing::ScratchFolder folder;
  const std::string path = (folder.path() / "notes.txt").string();
  ASSERT_TRUE(WriteFileAtomically(path, "take-off at noon, wind from the west\n"));
  const auto none = ReadTelemetry(path, {});
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::kDataLoss);
  EXPECT_THAT(none.error().message,
              AllOf(HasSubstr("notes.txt: not a video"),
                    HasSubstr("; telemetry is KLV, subtitles of DJI or Autel aircraft, or a table")));
}

TEST(VideoTelemetry, TelemetryThatIsNotReadIsNamed) {
  VideoInfo info{.streams = {{0, StreamType::kVideo, "h264"}, {1, StreamType::kData, "klv"}}};
  EXPECT_FALSE(DescribeUnreadTelemetry(info));
  info.streams.push_back({2, StreamType::kData, "gpmd"});
  EXPECT_THAT(DescribeUnreadTelemetry(info).value_or(""), HasSubstr("stream 2 is GPMF of a GoPro, which is not read"));
}

// Hexadecimal packets with their content as JSON.
class KlvCorpus : public ::testing::TestWithParam<const char*> {};

TEST_P(KlvCorpus, ItemsAndChecksums) {
  VICTORIOUS_DATA_OR_SKIP(folder, "real/fmv_klv/klvtool_hex");
  std::ifstream hex(folder / (std::string(GetParam()) + ".hex"));
  const std::string digits{std::istreambuf_iterator<char>(hex), {}};
  std::string bytes;
  for (std::size_t i = 0; i + 1 < digits.size(); i += 2) {
    bytes += static_cast<char>(std::stoi(digits.substr(i, 2), nullptr, 16));
  }
  std::ifstream json(folder / (std::string(GetParam()) + ".json"));
  const auto expected = nlohmann::json::parse(json);
  const auto telemetry = ParseTelemetry(bytes, {});
  ASSERT_TRUE(telemetry) << telemetry.error().message;
  const auto packet = ToJson(*telemetry)["packets"][0];
  EXPECT_EQ(packet["checksum"]["valid"], expected["checksum"]["valid"]);
  ASSERT_EQ(packet["items"].size(), expected["items"].size());
  for (std::size_t i = 0; i < packet["items"].size(); ++i) {
    const auto& item = packet["items"][i];
    const auto& wanted = expected["items"][i];
    EXPECT_EQ(item["number"], wanted["tag"]);
    EXPECT_EQ(item["name"], wanted["name"]);
    if (wanted["value"].is_number() || wanted["value"].is_null()) {
      EXPECT_EQ(item["value"], wanted["value"]);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(VideoTelemetry, KlvCorpus,
                         ::testing::Values("minimal", "signed_lat", "long_form_length", "nested_ls",
                                           "error_indicator"));

struct DjiFile {
  const char* name;
  int cues;
  std::size_t states;
  bool attitude;
};

void PrintTo(const DjiFile& file, std::ostream* out) { *out << file.name; }

class DjiFiles : public ::testing::TestWithParam<DjiFile> {};

TEST_P(DjiFiles, StatesOfEveryDialect) {
  VICTORIOUS_DATA_OR_SKIP(path, std::string("real/dji_srt/") + GetParam().name);
  const Telemetry telemetry = MustRead(path);
  EXPECT_EQ(telemetry.records, GetParam().cues);
  EXPECT_EQ(telemetry.states.size(), GetParam().states);
  for (const CameraState& state : telemetry.states) EXPECT_EQ(state.attitude.has_value(), GetParam().attitude);
}

INSTANTIATE_TEST_SUITE_P(VideoTelemetry, DjiFiles,
                         ::testing::Values(DjiFile{"callmarcus/samples_Mini5PRO_clip.SRT", 5, 5, false},
                                           DjiFile{"callmarcus/samples_neo2_clip_nogps.SRT", 6, 3, false},
                                           DjiFile{"juan_parser/air2s.srt", 17, 17, false},
                                           DjiFile{"juan_parser/broken_incomplete.SRT", 20, 19, false},
                                           DjiFile{"juan_parser/matrice_300.srt", 381, 381, false},
                                           DjiFile{"juan_parser/mavic_2_style.SRT", 468, 463, false},
                                           DjiFile{"juan_parser/mavic_air.SRT", 2, 0, false},
                                           DjiFile{"juan_parser/mavic_pro_buggy.SRT", 546, 530, false},
                                           DjiFile{"juan_parser/old_format.SRT", 468, 468, false},
                                           DjiFile{"juan_parser/p4_rtk.SRT", 55, 55, true},
                                           DjiFile{"nunzio_mini2/DJI_0023.SRT", 1203, 1203, false},
                                           DjiFile{"ruz76/DJI.SRT", 7, 7, true},
                                           DjiFile{"ruz76/DJI_M300RTK.SRT", 7, 7, true},
                                           DjiFile{"ruz76/DJI_MAVIC_2_ZOOM.SRT", 10, 10, false}));

TEST(VideoTelemetry, ReadsTableBesideTheVideo) {
  VICTORIOUS_DATA_OR_SKIP(path, "movies/dev_soft/telemetry.csv");
  const Telemetry telemetry = MustRead(path);
  EXPECT_GT(telemetry.states.size(), 10U);
  EXPECT_TRUE(std::ranges::all_of(telemetry.states, &CameraState::IsComplete));
  EXPECT_THAT(telemetry.warnings, IsEmpty());
}

TEST(VideoTelemetry, FindsFilesBesideAVideo) {
  const testing::ScratchFolder folder;
  const std::string video = folder / "flight.mp4";
  EXPECT_EQ(FindTelemetryFile(video), std::nullopt);
  std::ofstream(folder / "flight.telemetry.csv") << "time_s\n";
  EXPECT_EQ(FindTelemetryFile(video), folder / "flight.telemetry.csv");
  std::ofstream(folder / "flight.mp4.telemetry.csv") << "time_s\n";
  EXPECT_EQ(FindTelemetryFile(video), folder / "flight.mp4.telemetry.csv");
  std::ofstream(folder / "flight.SRT") << "1\n";
  EXPECT_EQ(FindTelemetryFile(video), folder / "flight.SRT");
}

TEST(VideoTelemetry, ReportsWhyItIsUnusable) {
  CameraState known{.time_s = 100, .place = {}, .attitude = Attitude{}, .hfov_rad = 0.3};
  CameraState later = known;
  later.time_s = 160;
  const std::vector<CameraState> states = {known, later};
  EXPECT_FALSE(DescribeMismatch(states, 120)) << "the last 20 s";
  EXPECT_FALSE(DescribeMismatch(states, {})) << "it may be long enough";
  EXPECT_THAT(DescribeMismatch(states, 6).value_or(""), HasSubstr("100.00 to 160.00 s, but the video 0 to 6.00 s"));
  known.time_s = -50;
  later.time_s = -1;
  EXPECT_THAT(DescribeMismatch(std::vector{known, later}, {}).value_or(""), HasSubstr("-50.00 to -1.00 s"));
  known.time_s = 3;
  known.hfov_rad.reset();
  EXPECT_THAT(DescribeMismatch(std::vector{known}, 6).value_or(""), HasSubstr("field of view"));
}

TEST(DescribeUnderground, HeightsBelowTheGroundAreReported) {
  const FlatGround ground(500);
  std::vector<CameraState> states(3);
  for (CameraState& state : states) state.place = {0.8, 0.2, 600};
  EXPECT_FALSE(DescribeUnderground(states, ground));
  states[0].place.altitude_m = 80;
  EXPECT_FALSE(DescribeUnderground(states, ground)) << "one state of three";
  states[1].place.altitude_m = 100;
  EXPECT_THAT(DescribeUnderground(states, ground), Optional(HasSubstr("400 m under the ground")));
  for (CameraState& state : states) state.datum = VerticalDatum::kTakeoff;
  EXPECT_FALSE(DescribeUnderground(states, ground)) << "the heights are unknown";
}

}  // namespace
}  // namespace victorious

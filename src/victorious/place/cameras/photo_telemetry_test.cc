#include "victorious/place/cameras/photo_telemetry.h"

#include <filesystem>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "testing/data.h"
#include "testing/photo_file.h"
#include "victorious/base/file.h"
#include "victorious/geometry/angles.h"
#include "victorious/input/telemetry/photo.h"
#include "victorious/input/video/video_reader.h"
#include "victorious/place/cameras/camera_states.h"
#include "victorious/place/cameras/video_telemetry.h"

namespace victorious {
namespace {

using ::testing::Contains;
using testing::DjiXmp;
using ::testing::HasSubstr;
using testing::PhotoTags;

class PhotoTelemetry : public ::testing::Test {
 protected:
  void Write(const std::string& name, const PhotoTags& tags) {
    std::vector<unsigned char> jpeg;
    ASSERT_TRUE(cv::imencode(".jpg", cv::Mat(48, 64, CV_8UC3, cv::Scalar(90, 120, 60)), jpeg));
    ASSERT_TRUE(WriteFileAtomically((folder_.path() / name).string(),
                                    testing::WithTags(std::string(jpeg.begin(), jpeg.end()), tags)));
  }

  CameraStates Load(double frame_rate) {
    const auto reader = VideoReader::Open(folder_.path().string(), {.folder_frame_rate = frame_rate});
    EXPECT_TRUE(reader);
    auto cameras = CameraStates::Load(folder_.path().string(), (*reader)->info(), std::nullopt, {}, "no place",
                                      [&](const std::string& warning) { warnings_.push_back(warning); });
    EXPECT_TRUE(cameras);
    return *std::move(cameras);
  }

  testing::ScratchFolder folder_;
  std::vector<std::string> warnings_;
};

// "2" before "10"; the damaged first image is none of the video, whose times start at the first readable one.
TEST_F(PhotoTelemetry, StatesHaveTheTimesOfTheirFrames) {
  ASSERT_TRUE(WriteFileAtomically((folder_.path() / "1.jpg").string(), "damaged"));
  Write("2.jpg", {.latitude_deg = 48.2, .xmp = DjiXmp(10, -60, 560, 40)});
  Write("3.jpg", {.latitude_deg = 0, .longitude_deg = 0});
  Write("10.jpg", {.latitude_deg = 48.3, .xmp = DjiXmp(20, -60, 560, 40)});
  const CameraStates cameras = Load(4);
  EXPECT_TRUE(cameras.is_of_photos());
  const auto latitude_deg = [&](double time_s) {
    const auto state = cameras.At(time_s);
    return state ? DegreesFromRadians(state->place.latitude_rad) : 0;
  };
  EXPECT_NEAR(latitude_deg(0), 48.2, 1e-6);
  EXPECT_NEAR(latitude_deg(0.5), 48.3, 1e-6);
  EXPECT_EQ(latitude_deg(0.25), 0) << "a photo without a position is not placed between its neighbours";
  EXPECT_EQ(latitude_deg(0.55), 0) << "nor after the last";
  EXPECT_NEAR(DegreesFromRadians(cameras.At(0.5)->attitude->yaw_rad), 20, 1e-6);
  EXPECT_THAT(warnings_, Contains(HasSubstr("1 of 3 photos have no position")));
}

// Each photo has its own time: those of the frames are made up.
TEST_F(PhotoTelemetry, AFolderOfPhotosHasNoClock) {
  Write("1.jpg", {.latitude_deg = 48.1, .xmp = DjiXmp(10, -60, 560, 40)});
  Write("2.jpg", {.latitude_deg = 48.2, .utc_date = "2026:05:27", .xmp = DjiXmp(10, -60, 560, 40)});
  const CameraStates cameras = Load(10);
  EXPECT_FALSE(cameras.start_utc_us());
  EXPECT_TRUE(cameras.At(0.1)->utc_us) << "the photo's own, as for the sun";
}

// The tags of thermal photos can stand behind megabytes.
TEST(PhotoHead, OtherSegmentsAreSkipped) {
  const std::string photo = testing::PhotoHead({.latitude_deg = 48.2, .xmp = DjiXmp(10, -60, 560, 40)}, 640, 512);
  std::string long_photo = photo.substr(0, 2);
  for (int i = 0; i < 200; ++i) long_photo += testing::photo_file::Segment('\xE3', std::string(60'000, '\xFF'));
  long_photo += photo.substr(2) + "image data";
  std::istringstream file(long_photo);
  EXPECT_EQ(ReadPhotoHead(file), photo);
  const auto read = ReadPhotoMetadata(std::as_bytes(std::span(photo)));
  ASSERT_TRUE(read);
  EXPECT_NEAR(read->latitude_deg.value(), 48.2, 1e-8);
  for (const std::string& damaged :
       {std::string("\x89PNG"), std::string("\xFF\xD8"), std::string("\xFF\xD8\xFF\xE1\0\1", 6)}) {
    std::istringstream bytes(damaged);
    EXPECT_LE(ReadPhotoHead(bytes).size(), 2U);
  }
}

TEST_F(PhotoTelemetry, OneImageIsAVideoOfOneState) {
  Write("a.jpg", {.latitude_deg = 48.2, .xmp = DjiXmp(10, -60, 560, 40)});
  const auto telemetry = ReadTelemetry((folder_.path() / "a.jpg").string(), {});
  ASSERT_TRUE(telemetry) << telemetry.error().message;
  EXPECT_EQ(telemetry->format, TelemetryFormat::kPhotos);
  ASSERT_EQ(telemetry->states.size(), 1U);
  EXPECT_EQ(telemetry->states[0].time_s, 0);
}

TEST_F(PhotoTelemetry, FoldersWithoutPositionsHaveNoTelemetry) {
  Write("a.jpg", {.latitude_deg = 0, .longitude_deg = 0});
  const CameraStates cameras = Load(10);
  EXPECT_FALSE(cameras.HasStates());
  EXPECT_FALSE(cameras.is_of_photos());
  const auto read = ReadTelemetry(folder_.path().string(), {});
  ASSERT_FALSE(read);
  EXPECT_THAT(read.error().message, HasSubstr("no image has a position"));
}

TEST_F(PhotoTelemetry, ATableBesideTheFolderTakesPrecedence) {
  Write("a.jpg", {.latitude_deg = 48.2, .xmp = DjiXmp(10, -60, 560, 40)});
  const std::string table = folder_.path().string() + ".telemetry.csv";
  ASSERT_TRUE(WriteFileAtomically(table, "time_s,latitude_deg,longitude_deg,altitude_m\n0,47,11,500\n"));
  EXPECT_NEAR(DegreesFromRadians(Load(10).At(0).value().place.latitude_rad), 47, 1e-9);
  std::filesystem::remove(table);
}

TEST(PhotoTelemetryData, PhotosOfARealFlight) {
  VICTORIOUS_DATA_OR_SKIP(folder, "real/geo_gcp/brighton_beach");
  const auto telemetry = ReadTelemetry(folder.string(), {});
  ASSERT_TRUE(telemetry) << telemetry.error().message;
  ASSERT_EQ(telemetry->states.size(), 12U);
  const CameraState& first = telemetry->states[0];  // telemetry.csv there, read from the same photo by another program
  EXPECT_NEAR(DegreesFromRadians(first.place.latitude_rad), 46.8426070833333, 1e-8);
  EXPECT_NEAR(DegreesFromRadians(first.place.longitude_rad), -91.9945598888889, 1e-8);
  EXPECT_NEAR(DegreesFromRadians(first.attitude.value().yaw_rad), 45, 1e-6);
  EXPECT_NEAR(DegreesFromRadians(first.attitude->pitch_rad), -89.9, 1e-6);
  EXPECT_NEAR(DegreesFromRadians(first.hfov_rad.value()), 81.6, 0.2) << "3.61 mm on a sensor 6.17 mm wide: 81.0";
}

}  // namespace
}  // namespace victorious

#include "victorious/input/telemetry/photo.h"

#include <span>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/photo_file.h"
#include "victorious/geometry/angles.h"
#include "victorious/input/telemetry/telemetry.h"

namespace victorious {
namespace {

using ::testing::Contains;
using testing::DjiXmp;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::PhotoHead;
using testing::PhotoTags;

std::optional<PhotoMetadata> Read(const std::string& bytes) {
  return ReadPhotoMetadata(std::as_bytes(std::span(bytes)));
}

PhotoMetadata MustRead(const PhotoTags& tags, int width = 4000, int height = 3000) {
  const auto photo = Read(PhotoHead(tags, width, height));
  EXPECT_TRUE(photo);
  return photo.value_or(PhotoMetadata());
}

TEST(Photo, PlaceHeightAndTimeOfExif) {
  const PhotoMetadata photo = MustRead(
      {.latitude_deg = -33.8567844, .longitude_deg = 151.2152967, .altitude_m = 87.25, .utc_date = "2026:05:27"});
  EXPECT_NEAR(photo.latitude_deg.value(), -33.8567844, 1e-8);
  EXPECT_NEAR(photo.longitude_deg.value(), 151.2152967, 1e-8);
  EXPECT_NEAR(photo.altitude_m.value(), 87.25, 1e-6);
  EXPECT_EQ(photo.camera, "FC6310");
  EXPECT_EQ(photo.focal_35mm_mm, 24);
  EXPECT_EQ(photo.utc_us, 1'779'885'296'000'000);
  EXPECT_FALSE(photo.attitude);
}

TEST(Photo, APositionWithoutItsHemispheresIsNone) {
  const std::string xmp = "<d drone-dji:GpsLatitude=\"-33.5\" drone-dji:GpsLongitude=\"-70.5\"/>";
  const PhotoMetadata by_xmp = MustRead({.has_hemispheres = false, .xmp = xmp});
  EXPECT_EQ(by_xmp.latitude_deg, -33.5);
  EXPECT_EQ(by_xmp.longitude_deg, -70.5);
  const PhotoMetadata without = MustRead({.has_hemispheres = false});
  EXPECT_FALSE(without.HasPlace()) << "it may be south or west";
  const auto telemetry = TelemetryFromPhotos(std::vector{without, MustRead({})}, {});
  ASSERT_TRUE(telemetry);
  EXPECT_THAT(telemetry->warnings, Contains(HasSubstr("1 of 2 photos have no position")));
}

TEST(Photo, GimbalAnglesAndHeightsOfXmpAsAttributesAndAsElements) {
  const std::string elements =
      "<drone-dji:GimbalYawDegree>+45.00</drone-dji:GimbalYawDegree> <drone-dji:GimbalPitchDegree>-60.00"
      "</drone-dji:GimbalPitchDegree><drone-dji:GimbalRollDegree>+0.00</drone-dji:GimbalRollDegree>"
      "<drone-dji:AbsoluteAltitude>+560.00</drone-dji:AbsoluteAltitude>"
      "<drone-dji:RelativeAltitude>+40.00</drone-dji:RelativeAltitude>";
  for (const std::string& xmp : {DjiXmp(45, -60, 560, 40), elements}) {
    const PhotoMetadata photo = MustRead({.altitude_m = 1, .xmp = xmp});
    ASSERT_TRUE(photo.attitude) << xmp;
    EXPECT_NEAR(DegreesFromRadians(photo.attitude->yaw_rad), 45, 1e-6);
    EXPECT_NEAR(DegreesFromRadians(photo.attitude->pitch_rad), -60, 1e-6);
    EXPECT_EQ(photo.altitude_m, 560) << "not EXIF's, which is rounded on some aircraft";
    EXPECT_EQ(photo.above_takeoff_m, 40);
  }
}

TEST(Photo, RtkHeightsAreAboveTheEllipsoidAndHaveErrors) {
  const PhotoMetadata photo =
      MustRead({.xmp = "<d drone-dji:AltitudeType=\"RtkAlt\" drone-dji:AbsoluteAltitude=\"+560.0\" "
                       "drone-dji:RtkStdLon=\"0.03\" drone-dji:RtkStdLat=\"0.03\" drone-dji:RtkStdHgt=\"0.03\"/>"});
  const auto camera = CameraFromPhoto(photo, DjiHeight::kAboveSea, "");
  ASSERT_TRUE(camera);
  EXPECT_EQ(camera->datum, VerticalDatum::kEllipsoid);
  EXPECT_NEAR(camera->sigma_position_m.value(), 0.03, 1e-9);
}

TEST(Photo, FieldOfViewIsThatOfTheSensorAndTheCrop) {
  const auto hfov_deg = [](const std::string& model, int width, int height, const std::string& given = "") {
    const auto camera = CameraFromPhoto(MustRead({.model = model}, width, height), DjiHeight::kAboveSea, given);
    return DegreesFromRadians(camera.value().hfov_rad.value());
  };
  EXPECT_NEAR(hfov_deg("FC6310", 5472, 3648), 73.7, 0.1) << "the whole sensor of 3:2";
  EXPECT_NEAR(hfov_deg("FC6310", 5472, 3078), 73.7, 0.1) << "16:9: as wide";
  EXPECT_NEAR(hfov_deg("FC6310", 4864, 3648), 67.4, 0.1) << "4:3: narrower";
  EXPECT_NEAR(hfov_deg("other", 4000, 3000), 71.6, 0.1) << "by the diagonal of the photo";
  EXPECT_NEAR(hfov_deg("other", 4000, 2250), 73.7, 0.1) << "cropped by an unknown amount";
  EXPECT_NEAR(hfov_deg("other", 4000, 2250, "mavic-3"), 71.6, 0.1);
  const auto without = CameraFromPhoto(MustRead({.model = "other", .focal_35mm_mm = 0}), DjiHeight::kAboveSea, "");
  EXPECT_FALSE(without.value().hfov_rad);
}

TEST(Photo, ForeignAndDamagedFilesGiveNothing) {
  const std::string good = PhotoHead({.xmp = DjiXmp(45, -60, 560, 40)});
  EXPECT_FALSE(Read(""));
  EXPECT_FALSE(Read("\x89PNG\r\n\x1a\n"));
  EXPECT_FALSE(Read(good.substr(0, good.size() / 2)));
  std::string wrong_offsets = good;
  for (std::size_t i = 20; i < 60; ++i) wrong_offsets[i] = '\xFF';
  const auto damaged = Read(wrong_offsets);
  EXPECT_TRUE(!damaged || !damaged->HasPlace());
}

TEST(Photo, StatesOfPhotosAndWhatTheyLack) {
  std::vector<PhotoMetadata> photos;
  for (const PhotoTags& tags :
       std::vector<PhotoTags>{{.xmp = DjiXmp(45, -60, 560, 40)},
                              {.latitude_deg = 0, .longitude_deg = 0, .xmp = DjiXmp(45, -60, 560, 40)},
                              {.orientation = 6, .xmp = DjiXmp(45, -60, 560, 40)},
                              {.longitude_deg = 11.001, .xmp = DjiXmp(45, -60, 560, 40)}}) {
    photos.push_back(MustRead(tags));
    photos.back().time_s = 0.1 * static_cast<double>(photos.size());
  }
  const auto telemetry = TelemetryFromPhotos(photos, {.takeoff_altitude_m = 500});
  ASSERT_TRUE(telemetry);
  EXPECT_EQ(telemetry->records, 4);
  ASSERT_EQ(telemetry->states.size(), 2U);
  EXPECT_NEAR(telemetry->states[1].time_s, 0.4, 1e-12);
  EXPECT_NEAR(telemetry->states[0].place.altitude_m, 540, 1e-9) << "above the given take-off";
  EXPECT_TRUE(telemetry->states[0].IsComplete());
  EXPECT_THAT(telemetry->warnings, Contains(HasSubstr("1 of 4 photos have no position")));
  EXPECT_THAT(telemetry->warnings, Contains(HasSubstr("1 of 4 photos are turned")));
  EXPECT_THAT(telemetry->warnings, Not(Contains(HasSubstr("for places"))));
}

TEST(Photo, WithoutGimbalAnglesTheFlagIsNamed) {
  const auto telemetry = TelemetryFromPhotos(std::vector{MustRead({})}, {});
  ASSERT_TRUE(telemetry);
  EXPECT_THAT(telemetry->warnings, Contains(HasSubstr("for places give --nadir")));
}

}  // namespace
}  // namespace victorious

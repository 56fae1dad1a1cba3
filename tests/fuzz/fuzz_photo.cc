// Fuzzes the reader of the EXIF and XMP tags of photos.
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "testing/photo_file.h"
#include "tests/fuzz/fuzz_target.h"
#include "victorious/base/check.h"
#include "victorious/input/telemetry/photo.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto photo = victorious::ReadPhotoMetadata(std::as_bytes(std::span(data, size)));
  if (!photo) return 0;
  for (const victorious::DjiHeight height : {victorious::DjiHeight::kAboveSea, victorious::DjiHeight::kAboveTakeoff}) {
    const auto camera = victorious::CameraFromPhoto(*photo, height, "");
    if (!camera) continue;
    VICTORIOUS_CHECK(std::isfinite(camera->place.altitude_m));
    VICTORIOUS_CHECK(std::abs(camera->place.latitude_rad) < 1.571 && std::abs(camera->place.longitude_rad) < 3.142);
    VICTORIOUS_CHECK(!camera->attitude || std::isfinite(camera->attitude->roll_rad));
    VICTORIOUS_CHECK(!camera->hfov_rad || (*camera->hfov_rad > 0 && *camera->hfov_rad < 3.15));
    VICTORIOUS_CHECK(!camera->sigma_position_m || std::isfinite(*camera->sigma_position_m));
  }
  return 0;
}

std::vector<std::string> FuzzSeeds() {
  using victorious::testing::DjiXmp;
  using victorious::testing::PhotoHead;
  return {PhotoHead({.utc_date = "2026:05:27", .xmp = DjiXmp(45, -60, 560, 40)}),
          PhotoHead({.model = "other", .orientation = 6, .latitude_deg = -33.8, .longitude_deg = -151.2}),
          PhotoHead({.focal_35mm_mm = 0,
                     .latitude_deg = 0,
                     .longitude_deg = 0,
                     .xmp = "<drone-dji:GpsLatitude>48.1</drone-dji:GpsLatitude> drone-dji:GpsLongtitude=\"11.5\" "
                            "drone-dji:AltitudeType='RtkAlt' drone-dji:AbsoluteAltitude='+5.0' "
                            "drone-dji:RtkStdLon=\"0.03\" drone-dji:RtkStdLat=\"0.03\" drone-dji:RtkStdHgt=\"0.03\""}),
          ""};
}

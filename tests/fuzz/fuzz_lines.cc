// Fuzzes the reader of lines of sight: it reads them or fails with a one-line error; the estimated place must be finite
// or absent.
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "tests/fuzz/fuzz_target.h"
#include "victorious/base/check.h"
#include "victorious/place/geolocate/lines_csv.h"
#include "victorious/place/geolocate/locate.h"

namespace {

void CheckFix(const victorious::GeoFix& fix, std::size_t lines) {
  VICTORIOUS_CHECK(fix.inliers.size() == lines);
  VICTORIOUS_CHECK((fix.status == victorious::LocateStatus::kOk) == fix.place.has_value());
  if (!fix.place) return;
  VICTORIOUS_CHECK(fix.place->covariance_enu_m2.allFinite());
  VICTORIOUS_CHECK(fix.place->point.altitude_m == fix.place->point.altitude_m);
  VICTORIOUS_CHECK(fix.place->ce90_m > 0 && fix.place->le90_m >= 0);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto table = victorious::ParseLinesOfSight({reinterpret_cast<const char*>(data), size}, "lines.csv");
  if (!table) {
    VICTORIOUS_CHECK(table.error().message.find('\n') == std::string::npos);
    return 0;
  }
  for (const auto motion : {victorious::MotionModel::kStatic, victorious::MotionModel::kVelocity}) {
    for (const auto& [method, text] : victorious::kLocateMethodTexts) {
      victorious::LocateOptions options{.motion = motion, .method = method, .max_hypotheses = 50};
      if (options.method == victorious::LocateMethod::kGround)
        options.ground = std::make_shared<victorious::FlatGround>(10);
      const auto fix = victorious::Locate(table->lines, options);
      VICTORIOUS_CHECK(fix.has_value());
      CheckFix(*fix, table->lines.size());
    }
  }
  return 0;
}

std::vector<std::string> FuzzSeeds() {
  const std::string header = "time_s,latitude_deg,longitude_deg,altitude_m,azimuth_deg,elevation_deg";
  const std::string row = "0,42.36,-71.09,200,10,-30";
  const std::string ranges = header + ",range_m,sigma_deg,sigma_range_m\n" + row +
                             ",300,0.5,30\n1,42.361,-71.09,200,120,-30,310,,\n" + "2,42.362,-71.09,200,160,-30,,1,\n";
  const std::string circle =
      header + "\n0,42.360,-71.092,200,90,-50\n1,42.358,-71.090,200,0,-42\n2,42.360,-71.088,200,270,-50\n" +
      "3,42.362,-71.090,200,180,-42\n";
  return {"",
          header,
          header + "\n" + row,
          ranges,
          circle,
          "\xEF\xBB\xBF" + header + "\r\n" + row + "\r\n",
          header + "\n0,90,0,0,0,-90\n1,-90,360,1e7,360,90\n",
          header + "\n" + row + "\n" + row + "\n" + row};
}

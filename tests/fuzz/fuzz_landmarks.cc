// Fuzzes the reader of landmark lists: it reads them or fails with a one-line error; places read must be valid.
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "tests/fuzz/fuzz_target.h"
#include "victorious/base/check.h"
#include "victorious/jobs/navigate/landmark_list.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto list = victorious::ParseLandmarks({reinterpret_cast<const char*>(data), size}, {});
  if (!list) {
    VICTORIOUS_CHECK(list.error().message.find('\n') == std::string::npos);
    return 0;
  }
  for (const std::string& warning : list->warnings) VICTORIOUS_CHECK(warning.find('\n') == std::string::npos);
  for (const victorious::Landmark& landmark : list->landmarks) {
    VICTORIOUS_CHECK(std::abs(landmark.place.latitude_rad) < 1.58 && std::isfinite(landmark.place.altitude_m));
    VICTORIOUS_CHECK(landmark.covariance_enu_m2.allFinite() && landmark.covariance_enu_m2.trace() >= 0);
  }
  return 0;
}

std::vector<std::string> FuzzSeeds() {
  const std::string landmark =
      R"({"model":"jeep","latitude_deg":52.5,"longitude_deg":13.4,"altitude_m":75.5,"heading_deg":90.0,)"
      R"("covariance_enu_m2":[[0.04,0.01,0],[0.01,0.09,0],[0,0,0.25]],"speed_m_s":0.0})";
  return {"",
          "\n",
          landmark,
          landmark + "\r\n\n" + landmark,
          landmark.substr(0, landmark.size() / 2),
          R"({"model":"a\nb","latitude_deg":0,"longitude_deg":0,"altitude_m":1e999})",
          "[[[[",
          "{}"};
}

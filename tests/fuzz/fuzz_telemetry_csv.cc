// Fuzzes the reader of telemetry tables: it reads them or fails with a one-line error; tables read survive a round
// trip.
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "tests/fuzz/fuzz_target.h"
#include "victorious/base/check.h"
#include "victorious/input/telemetry/camera_csv.h"
#include "victorious/input/telemetry/camera_track.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto rows = victorious::ParseCameraCsv({reinterpret_cast<const char*>(data), size});
  if (!rows) {
    VICTORIOUS_CHECK(rows.error().message.find('\n') == std::string::npos);
    return 0;
  }
  const auto again = victorious::ParseCameraCsv(victorious::FormatCameraCsv(rows->states));
  VICTORIOUS_CHECK(again.has_value() && again->states.size() == rows->states.size());
  const victorious::CameraTrajectory track(rows->states, 2);
  for (const victorious::CameraState& state : rows->states) {
    VICTORIOUS_CHECK(track.At(state.time_s).has_value());
    (void)track.At(state.time_s + 0.5);
  }
  return 0;
}

std::vector<std::string> FuzzSeeds() {
  const std::string header = "time_s,latitude_deg,longitude_deg,altitude_m,yaw_deg,pitch_deg,roll_deg,hfov_deg";
  return {header + "\n0,42,-71,100,0,-90,0,40\n0.1,42.1,-71,100,350,-45,0,40\n",
          "altitude_m,time_s,longitude_deg,latitude_deg,vertical_datum,utc,k1,k2,p1,p2,sigma_position_m\n"
          "1,2,3,4,egm96,2026-05-27T13:14:22.5Z,0.1,0.2,0.3,0.4,5\r\n",
          "Time_s;Latitude_deg;Longitude_deg;Altitude_m\r\n0,5;42,25;-71;\"100\"\r\n",
          std::string("\xFF\xFEt\0i\0m\0e\0_\0s\0", 14),
          header + ",sigma_attitude_deg\n0,95,-71,100,0,-90,0,40,1\n,,,\n1e308,1,1,1\n",
          header,
          ""};
}

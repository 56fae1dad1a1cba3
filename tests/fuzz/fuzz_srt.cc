// Fuzzes the reader of DJI subtitles.
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "tests/fuzz/fuzz_target.h"
#include "victorious/base/check.h"
#include "victorious/input/telemetry/dji_srt.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  (void)victorious::LooksLikeDjiSrt(text);
  (void)victorious::CameraFromDjiText(text);
  const victorious::DjiSubtitles subtitles = victorious::ParseDjiSrt(text);
  VICTORIOUS_CHECK(subtitles.states.size() <= static_cast<std::size_t>(subtitles.cues));
  for (const victorious::CameraState& state : subtitles.states) {
    VICTORIOUS_CHECK(std::isfinite(state.time_s) && std::isfinite(state.place.altitude_m));
    VICTORIOUS_CHECK(std::abs(state.place.latitude_rad) < 1.571 && std::abs(state.place.longitude_rad) < 3.142);
    VICTORIOUS_CHECK(!state.attitude || std::isfinite(state.attitude->roll_rad));
    VICTORIOUS_CHECK(!state.hfov_rad || (*state.hfov_rad > 0 && *state.hfov_rad < 3.15));
  }
  return 0;
}

std::vector<std::string> FuzzSeeds() {
  return {
      "1\n00:00:00,000 --> 00:00:00,033\n<font size=\"28\">FrameCnt: 1\n2024-04-23 14:04:07.002\n[focal_len: 24.00] "
      "[dzoom: 1.00]\n[latitude: 49.3] [longitude: 15.0] [rel_alt: 43.2 abs_alt: 758.9]\n[gb_yaw: -8.6 gb_pitch: "
      "-86.7 gb_roll: 0.0]\n\n0\n[ct : 5256]</font>\n\n2\n00:00:00,033 --> 00:00:00,066\n",
      "1\n00:00:01,000 --> 00:00:02,000\nHOME(149.0251,-20.2532) 2017.08.05 14:11:51\nGPS(149.0251,-20.2533,16) "
      "BAROMETER:1.9\n\n",
      "1\r\n00:00:00,000 --> 00:00:01,000\r\nGPS (-58.8, -34.2, 15), H 85.80m, G.PRY (-24.4, 0.0, 110.4)\r\n",
      "1\n2017.08.05 14:11:51,393,525\n[latitude : -20.2533] [longtitude : 149.0251]\n\n",
      "1\n00:00:00,000 --> 00:00:01,000\nGPS(W: 71.1, N: -42.1, 86.4m) ReH:8\nG.PRY (-5, 2, 3)\n\n2\n00:00:01,000 --> "
      "00:00:02,000\nGPS(W: 71.1, N: 4",
      "[Script Info]\n[Events]\nDialogue: 0,0:00:01.50,0:00:02.00,Default,,0,0,0,,GPS(W: 71.1, N: 42.1, 86) \\NISO\n",
      "1\n00:00:00,000 --> 00:00:01,000\nGPS(36.6146,-6.1120,0.0M) BAROMETER:0.3M\n",
      ""};
}

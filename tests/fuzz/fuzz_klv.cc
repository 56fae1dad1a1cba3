// Fuzzes the KLV decoder. It decodes as far as possible; decoded camera states must be valid positions on the Earth.
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "testing/klv_tools.h"
#include "tests/fuzz/fuzz_target.h"
#include "victorious/base/check.h"
#include "victorious/input/telemetry/telemetry.h"
#include "victorious/input/telemetry/telemetry_report.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto bytes = victorious::AsBytes(text);
  const victorious::DataPacket packet{
      .stream = 0, .kind = victorious::DataKind::kKlv, .time_s = 0.0, .bytes = {bytes.begin(), bytes.end()}};
  const auto telemetry = victorious::TelemetryFromPackets(std::vector{packet}, {});
  VICTORIOUS_CHECK(telemetry.has_value());
  for (const victorious::CameraState& state : telemetry->states) {
    VICTORIOUS_CHECK(std::isfinite(state.time_s) && std::isfinite(state.place.altitude_m));
    VICTORIOUS_CHECK(std::abs(state.place.latitude_rad) < 1.571 && std::abs(state.place.longitude_rad) < 3.142);
    VICTORIOUS_CHECK(state.attitude.has_value() && std::isfinite(state.attitude->yaw_rad));
  }
  VICTORIOUS_CHECK(!victorious::ToJson(*telemetry).dump().empty());
  VICTORIOUS_CHECK(!victorious::DescribeTelemetry(*telemetry).empty());
  const auto file = victorious::ParseTelemetry(text, {});
  VICTORIOUS_CHECK(file || file.error().message.find('\n') == std::string::npos);
  return 0;
}

std::vector<std::string> FuzzSeeds() {
  const std::string camera = victorious::testing::CameraPacket(1'600'000'000'000'000);
  const std::string item = std::string("\x06\x0E\x2B\x34\x01\x01\x01\x03\x07\x01\x02\x01\x02\x04\x02\x00\x08", 17) +
                           "\x40\x43\x14\x78\x96\x13\xD3\x1C";
  const std::string elder =
      std::string(victorious::testing::kEg0104LabelBytes) + victorious::testing::BerLength(item.size()) + item;
  const std::string packs = victorious::testing::St0601Packet({{3, "MISSION"},
                                                               {47, "\x31"},
                                                               {48, "\x01\x01\x03"},
                                                               {74, "\x01\x7F"},
                                                               {104, "\x12\x34\x56"},
                                                               {116, "\x03\x07"},
                                                               {6, "\x80"}});
  return {camera, camera + camera, elder, packs, "\x01\x02" + elder + camera.substr(0, 60), ""};
}

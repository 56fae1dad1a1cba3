// Fuzzes the truth reader: it reads the file or fails with a one-line error; truth read can be scored.
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "tests/fuzz/fuzz_target.h"
#include "victorious/base/check.h"
#include "victorious/lab/evaluate/score.h"
#include "victorious/lab/evaluate/truth.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto rows = victorious::ParseTruth({reinterpret_cast<const char*>(data), size}, "truth.jsonl");
  if (!rows) {
    VICTORIOUS_CHECK(rows.error().message.find('\n') == std::string::npos);
    return 0;
  }
  std::vector<victorious::ReportedSighting> sightings;
  for (const victorious::TruthRow& row : *rows) sightings.push_back({1, row.frame, row.model, row.box, 0.5, row.view});
  const victorious::Score score =
      victorious::ScoreIndex(*rows, std::vector<victorious::ReportedObject>{{.id = 1}}, sightings);
  VICTORIOUS_CHECK(!victorious::ToText(score).empty());
  return 0;
}

std::vector<std::string> FuzzSeeds() {
  const std::string row =
      R"({"frame":37,"time_s":1.48,"object":"humvee-1","model":"humvee","box":[1,2,30.5,40],"visible":0.93,"pixels":5120,)"
      R"("latitude_deg":null,"view":{"azimuth_deg":10,"off_nadir_deg":60}})";
  std::string flight;
  for (int frame = 0; frame < 12; ++frame) {
    flight +=
        R"({"frame":)" + std::to_string(frame) + R"(,"object":"a","model":"m","box":[0,0,30,30],"visible":1})" + "\n";
  }
  return {"",     "\n", row, row + "\r\n\n" + row, flight, row.substr(0, row.size() / 2), R"({"frame":1e999})",
          "[[[[", "{}"};
}

// Fuzzes the parser of the events of a child process: a line is an event that the writer writes again as it was read,
// or a one-line error.
#include <cstdint>
#include <string>
#include <vector>

#include "tests/fuzz/fuzz_target.h"
#include "victorious/base/check.h"
#include "victorious/base/program_events.h"

using victorious::ErrorCode;
using victorious::FormatEvent;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto event = victorious::ParseEvent({reinterpret_cast<const char*>(data), size});
  if (!event) {
    VICTORIOUS_CHECK(event.error().message.find('\n') == std::string::npos);
    return 0;
  }
  const std::string line = FormatEvent(*event);
  VICTORIOUS_CHECK(line.find('\n') == std::string::npos && line.size() <= victorious::kMaxEventBytes);
  const auto again = victorious::ParseEvent(line);
  VICTORIOUS_CHECK(again.has_value() && FormatEvent(*again) == line);
  return 0;
}

std::vector<std::string> FuzzSeeds() {
  using victorious::ProgressEvent;
  return {"",
          "error: not JSON",
          FormatEvent(ProgressEvent{.label = "a.mp4", .done = 12, .total = 40, .unit = "frames", .elapsed_s = 2.5}),
          FormatEvent(ProgressEvent{.label = "views", .done = 0, .total = {}, .unit = "views", .elapsed_s = 1e-3}),
          FormatEvent(victorious::InfoEvent{"a \"flight\".mp4: 12 frames searched"}),
          FormatEvent(victorious::WarningEvent{"no telemetry \xC3\xA9"}),
          FormatEvent(victorious::ErrorEvent{{ErrorCode::kDataLoss, "a.mp4: damaged"}}),
          FormatEvent(victorious::VideoLeftEvent{"/data/a.mp4"})};
}

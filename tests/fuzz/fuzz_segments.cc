// Fuzzes the readers of what workers store of a video that is cut: bytes of an index that is damaged, or of another
// build. They are refused, or are those that the writer makes of what was read.
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "tests/fuzz/fuzz_target.h"
#include "victorious/base/check.h"
#include "victorious/jobs/index/frame_results.h"
#include "victorious/jobs/index/video_cut.h"

namespace {

using victorious::FrameResult;
using victorious::PreparedVideo;
using victorious::SightingRecord;

std::string ToText(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span<const std::byte> bytes = std::as_bytes(std::span(data, size));
  if (const auto results = victorious::UnpackFrameResults(bytes)) {
    VICTORIOUS_CHECK(victorious::PackFrameResults(*results) == std::vector(bytes.begin(), bytes.end()));
  }
  if (const auto prepared = victorious::UnpackPreparedVideo(bytes)) {
    const auto again = victorious::UnpackPreparedVideo(victorious::PackPreparedVideo(*prepared));
    VICTORIOUS_CHECK(again && again->times_s.size() == prepared->times_s.size());
  }
  return 0;
}

std::vector<std::string> FuzzSeeds() {
  SightingRecord full{.video = 2,
                      .model = 3,
                      .frame = 120,
                      .time_s = 12.1,
                      .box = {0.1, 0.2, 30.3, 5},
                      .outline = {{1.1, 2.2}, {3.3, -4.4}},
                      .score = 0.7,
                      .view = victorious::ViewDirection{0.4, 0.5},
                      .track = 2'000'001};
  full.observation.emplace();
  const std::vector<FrameResult> results = {
      {.frame = 119,
       .is_whole = false,
       .now_from_before = victorious::Similarity2{1.1, -0.3, {0.1, 1}},
       .sightings = {}},
      {.frame = 120, .is_whole = true, .now_from_before = {}, .sightings = {full, SightingRecord{.frame = 120}}}};
  return {"", ToText(victorious::PackFrameResults({})), ToText(victorious::PackFrameResults(results)),
          ToText(victorious::PackPreparedVideo({.times_s = {0, 0.1, 0.2}, .cameras = {}, .file_bytes = 1000}))};
}

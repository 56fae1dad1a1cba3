// Fuzzes parameter files: accepted as a whole, or rejected with a one-line error; accepted values survive a round trip.
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/fuzz/fuzz_target.h"
#include "victorious/base/check.h"
#include "victorious/jobs/index/index_options.h"

using victorious::CollectFields;
using victorious::IndexOptions;
using victorious::OptionsToJsonText;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto json = nlohmann::json::parse(text, nullptr, /*allow_exceptions=*/false, /*ignore_comments=*/true);
  if (json.is_discarded()) return 0;
  const std::string before = OptionsToJsonText(IndexOptions{});
  IndexOptions options;
  if (const auto status = victorious::SetFromJson(json, CollectFields(options)); !status) {
    VICTORIOUS_CHECK(status.error().code == victorious::ErrorCode::kInvalidArgument);
    VICTORIOUS_CHECK(status.error().message.find('\n') == std::string::npos);
    VICTORIOUS_CHECK(OptionsToJsonText(options) == before);
    return 0;
  }
  VICTORIOUS_CHECK(victorious::ValidateOptions(options));
  const std::string after = OptionsToJsonText(options);
  IndexOptions again;
  VICTORIOUS_CHECK(victorious::SetFromJson(nlohmann::json::parse(after), CollectFields(again)));
  VICTORIOUS_CHECK(OptionsToJsonText(again) == after);
  return 0;
}

std::vector<std::string> FuzzSeeds() {
  return {OptionsToJsonText(IndexOptions{}),
          R"({"match": {"ratio": 0.75}, "keep.interval_s": 2, "every": 3})",
          R"({"tracklets": {"gap_s": 1e-300}, "features.engine": "opencv"})",
          R"({"pose": {"min_inliers": 18446744073709551615}, "every": -1, "features": {"max_side_px": 1e18}})",
          R"({"match": {"ratio": {"ratio": {"ratio": []}}}, "": null, "a\nb": "\ud83d\ude00"})",
          R"([{"match.ratio": 0.5}, true, "text"])",
          "/* comments */ {\"match.ratio\": 0.5} // are read over"};
}

// Fuzzes the handler of `victorious serve`: the first line of an input is the method, the second the target, the third
// the Range header, the rest the body. Every input gets a response with a status, and an error is one line of JSON.
#include <cstdint>
#include <filesystem>
#include <memory>
#include <sstream>
#include <string>

#include <nlohmann/json.hpp>

#include "testing/data.h"
#include "tests/fuzz/fuzz_target.h"
#include "victorious/base/check.h"
#include "victorious/serve/api.h"
#include "victorious/serve/byte_range.h"

namespace {

using victorious::HttpMethod;

// An index with one object, and a page.
struct Server {
  Server() {
    const auto store = victorious::OpenSqliteStore(folder / "index.db", victorious::StoreMode::kCreate);
    VICTORIOUS_CHECK(store.has_value());
    const auto video = (*store)->PutVideo({.content_id = "c", .name = "none.mp4", .width = 640, .height = 480});
    const auto model = (*store)->PutModel({.name = "jeep", .content_id = "m", .kind = victorious::ModelKind::kCad});
    victorious::IndexBatch batch;
    batch.tracklets.push_back({std::nullopt, {.video = video->id, .model = model->id, .score = 0.5, .frames = 1}});
    batch.sightings.push_back({0, {.box = {1, 2, 30, 40}, .score = 0.5, .matches = 9}});
    VICTORIOUS_CHECK((*store)->Commit(batch).has_value());
    auto opened =
        victorious::Api::Open({.index = folder / "index.db", .models = {}, .telemetry = {}, .web = {}}, cancel);
    VICTORIOUS_CHECK(opened.has_value());
    api = *std::move(opened);
  }

  victorious::testing::ScratchFolder folder;
  victorious::CancelToken cancel;
  std::unique_ptr<victorious::Api> api;
};

void CheckRange(const std::string& header) {
  for (const std::int64_t size : {0, 1, 1000}) {
    const victorious::ByteRange range = victorious::ParseByteRange(header, size);
    const bool is_part = range.kind == victorious::RangeKind::kPart;
    VICTORIOUS_CHECK(!is_part || (0 <= range.first && range.first <= range.last && range.last < size));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static Server server;
  std::istringstream input(std::string(reinterpret_cast<const char*>(data), size));
  std::string method;
  victorious::HttpRequest request{.host = "127.0.0.1:80", .content_type = "application/json"};
  std::getline(input, method);
  std::getline(input, request.target);
  std::getline(input, request.range);
  request.body.assign(std::istreambuf_iterator<char>(input), {});
  request.method = method == "PUT"    ? HttpMethod::kPut
                   : method == "POST" ? HttpMethod::kPost
                   : method == "GET"  ? HttpMethod::kGet
                                      : HttpMethod::kOther;
  CheckRange(request.range);
  const victorious::HttpResponse response = server.api->Handle(request, 80);
  VICTORIOUS_CHECK(response.status >= 200 && response.status < 600);
  VICTORIOUS_CHECK(response.status != 500);
  if (response.status < 400) return 0;
  const auto error = nlohmann::json::parse(response.body, nullptr, false);
  VICTORIOUS_CHECK(error.is_object() && error["code"].is_string() && error["message"].is_string());
  VICTORIOUS_CHECK(error["message"].get<std::string>().find('\n') == std::string::npos);
  return 0;
}

std::vector<std::string> FuzzSeeds() {
  return {"GET\n/api/v1/project\n",
          "GET\n/api/v1/objects?model=jeep&video=1&min_score=0.5&from=0&to=9&near=52,13,100&limit=5&cursor=0_0.5_1_1\n",
          "GET\n/api/v1/objects?sort=queue&since=5&around=1&q=jeep+1&review=none\n",
          "GET\n/api/v1/objects?ids=1,2&after=1\n",
          "GET\n/api/v1/objects/counts?near=90,0,1e7&q=%27+OR\n",
          "GET\n/api/v1/tiles/3/4/2?v=1&model=jeep\n",
          "GET\n/api/v1/objects/1\nbytes=0-99",
          "GET\n/api/v1/objects/1/sightings?from=0&to=1e3&limit=10\n",
          "GET\n/api/v1/objects/1/thumbnail?width=160\n",
          "GET\n/api/v1/videos/1/file\nbytes=-5",
          "GET\n/api/v1/videos/1/frames/0\nbytes=5-",
          "GET\n/api/v1/videos/1/times\n",
          "GET\n/api/v1/videos/1/camera\n",
          "GET\n/api/v1/models/1/views/0\n",
          "GET\n/assets/%69ndex.js?a=b+c%20\n",
          "PUT\n/api/v1/objects/1/review\n\n{\"verdict\": \"rejected\", \"note\": \"a shed\"}",
          "POST\n/api/v1/jobs\n\n{\"kind\": \"model\", \"name\": \"x\", \"uploads\": [\"0123456789abcdef\"], "
          "\"length_m\": 4}",
          "POST\n/api/v1/jobs\n\n{\"kind\": \"index\", \"upload\": \"0123456789abcdef\", \"telemetry\": \"x\"}",
          "POST\n/api/v1/jobs/1/cancel\n\n{}",
          "POST\n/api/v1/uploads?name=a.mp4\n\n",
          "POST\n/api/v1/project\n\n"};
}

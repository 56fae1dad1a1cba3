// Fuzzes the handler of `victorious serve`: the lines of an input are the method, the target, and the headers Range,
// Cookie and Authorization; the rest is the body. Every input gets a response with a status from a server without
// accounts and from one with accounts, and an error is one line of JSON. Without a credential, nothing of the index is
// told.
#include <cstdint>
#include <filesystem>
#include <memory>
#include <sstream>
#include <string>

#include <nlohmann/json.hpp>

#include "testing/data.h"
#include "tests/fuzz/fuzz_target.h"
#include "victorious/apps/serve/api.h"
#include "victorious/apps/serve/byte_range.h"
#include "victorious/apps/serve/secret.h"
#include "victorious/base/check.h"

namespace {

using victorious::HttpMethod;

constexpr char kSession[] = "sessionsessionsessionsessionsessionsession_";
constexpr char kToken[] = "tokentokentokentokentokentokentokentokento_";

// An index with one object, and a page.
struct Server {
  explicit Server(bool has_accounts) {
    const auto store = victorious::OpenSqliteStore(folder / "index.db", victorious::StoreMode::kCreate);
    VICTORIOUS_CHECK(store.has_value());
    const auto video = (*store)->PutVideo({.content_id = "c", .name = "none.mp4", .width = 640, .height = 480});
    const auto model = (*store)->PutModel({.name = "jeep", .content_id = "m", .kind = victorious::ModelKind::kCad});
    victorious::IndexBatch batch;
    batch.tracklets.push_back({std::nullopt, {.video = video->id, .model = model->id, .score = 0.5, .frames = 1}});
    batch.sightings.push_back({0, {.box = {1, 2, 30, 40}, .score = 0.5, .matches = 9}});
    VICTORIOUS_CHECK((*store)->Commit(batch).has_value());
    if (has_accounts) {
      constexpr std::int64_t kForEver = std::int64_t{1} << 60;
      const auto accounts = victorious::OpenAccountStore(folder / "index.db", victorious::StoreMode::kCreate).value();
      const auto account = accounts->Add("ann", victorious::Role::kAnalyst, "no hash", 1).value();
      using Kind = victorious::CredentialKind;
      for (const auto& [kind, secret] : {std::pair(Kind::kSession, kSession), std::pair(Kind::kToken, kToken)}) {
        const std::string digest = victorious::DigestSecret(secret);
        VICTORIOUS_CHECK(accounts
                             ->AddCredential({.account = account.id,
                                              .kind = kind,
                                              .digest = digest,
                                              .label = "",
                                              .now_us = 1,
                                              .lifetime_us = kForEver})
                             .has_value());
      }
    }
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

void CheckResponse(const victorious::HttpResponse& response) {
  VICTORIOUS_CHECK(response.status >= 200 && response.status < 600);
  VICTORIOUS_CHECK(response.status != 500);
  for (const auto& [name, value] : response.headers) {
    VICTORIOUS_CHECK(value.find_first_of("\r\n") == std::string::npos);
  }
  if (response.status < 400) return;
  const auto error = nlohmann::json::parse(response.body, nullptr, false);
  VICTORIOUS_CHECK(error.is_object() && error["code"].is_string() && error["message"].is_string());
  VICTORIOUS_CHECK(error["message"].get<std::string>().find('\n') == std::string::npos);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static Server server(/*has_accounts=*/false);
  static Server guarded(/*has_accounts=*/true);
  std::istringstream input(std::string(reinterpret_cast<const char*>(data), size));
  std::string method;
  victorious::HttpRequest request{.host = "127.0.0.1:80", .content_type = "application/json", .client = "127.0.0.1"};
  std::getline(input, method);
  std::getline(input, request.target);
  std::getline(input, request.range);
  std::getline(input, request.cookie);
  std::getline(input, request.authorization);
  request.body.assign(std::istreambuf_iterator<char>(input), {});
  request.method = method == "PUT"      ? HttpMethod::kPut
                   : method == "POST"   ? HttpMethod::kPost
                   : method == "DELETE" ? HttpMethod::kDelete
                   : method == "GET"    ? HttpMethod::kGet
                                        : HttpMethod::kOther;
  CheckRange(request.range);
  CheckResponse(server.api->Handle(request, 80));
  const victorious::HttpResponse guarded_response = guarded.api->Handle(request, 80);
  CheckResponse(guarded_response);
  const bool has_secret =
      request.cookie.find(kSession) != std::string::npos || request.authorization.find(kToken) != std::string::npos;
  if (!has_secret) {
    VICTORIOUS_CHECK(guarded_response.status >= 400 || guarded_response.body.find("jeep") == std::string::npos);
    request.method = HttpMethod::kGet;
    request.target = "/api/v1/project";
    VICTORIOUS_CHECK(guarded.api->Handle(request, 80).status == 401);
  }
  return 0;
}

std::vector<std::string> FuzzSeeds() {
  return {
      "GET\n/api/v1/project\n\n\n\n",
      "GET\n/api/v1/"
      "objects?model=jeep&video=1&min_score=0.5&from=0&to=9&near=52,13,100&limit=5&cursor=0_0.5_1_1\n\n\n\n",
      "GET\n/api/v1/objects?sort=queue&since=5&around=1&q=jeep+1&review=none\n\n\n\n",
      "GET\n/api/v1/objects?ids=1,2&after=1\n\n\n\n",
      "GET\n/api/v1/objects?key=0123456789abcdef.1500000.40.30.100.60.jeep\n\n\n\n",
      "GET\n/api/v1/objects/counts?near=90,0,1e7&q=%27+OR\n\n\n\n",
      "GET\n/api/v1/objects/counts?area=52,13,52.1,13,52,13.1\n\n\n\n",
      "GET\n/api/v1/objects/geopackage?review=rejected\n\n\n\n",
      "GET\n/api/v1/tiles/3/4/2?v=1&model=jeep\n\n\n\n",
      "GET\n/api/v1/objects/1\nbytes=0-99\n\n\n",
      "GET\n/api/v1/objects/1/sightings?from=0&to=1e3&limit=10\n\n\n\n",
      "GET\n/api/v1/objects/1/thumbnail?width=160\n\n\n\n",
      "GET\n/api/v1/videos/1/file\nbytes=-5\n\n\n",
      "GET\n/api/v1/videos/1/frames/0\nbytes=5-\n\n\n",
      "GET\n/api/v1/videos/1/times\n\n\n\n",
      "GET\n/api/v1/videos/1/camera\n\n\n\n",
      "GET\n/api/v1/models/1/coverage?video=1\n\n\n\n",
      "GET\n/api/v1/models/1/views\n\n\n\n",
      "GET\n/api/v1/models/1/views/0\n\n\n\n",
      "GET\n/api/v1/base_map\nbytes=0-99\n\n\n",
      "GET\n/api/v1/thresholds\n\n\n\n",
      "GET\n/api/v1/objects?thresholds=applied\n\n\n\n",
      "PUT\n/api/v1/models/1/threshold\n\n\n\n{\"min_score\": 0.9, \"reviewer\": \"ann\"}",
      "GET\n/assets/%69ndex.js?a=b+c%20\n\n\n\n",
      "PUT\n/api/v1/objects/1/review\n\n\n\n{\"verdict\": \"rejected\", \"note\": \"a shed\"}",
      "POST\n/api/v1/jobs\n\n\n\n{\"kind\": \"model\", \"name\": \"x\", \"uploads\": [\"0123456789abcdef\"], "
      "\"length_m\": 4}",
      "POST\n/api/v1/jobs\n\n\n\n{\"kind\": \"index\", \"upload\": \"0123456789abcdef\", \"telemetry\": \"x\"}",
      "POST\n/api/v1/jobs\n\n\n\n{\"kind\": \"copy\", \"video_id\": 1}",
      "GET\n/api/v1/videos/1/copy\nbytes=0-9\n\n\n",
      "GET\n/api/v1/cluster",
      "POST\n/api/v1/jobs/1/cancel\n\n\n\n{}",
      "POST\n/api/v1/jobs/1/retry\n\n\n\n{}",
      "DELETE\n/api/v1/jobs/1\n\n\n\n",
      "GET\n/api/v1/videos?shows=52.5,13.4\n\n\n\n",
      "POST\n/api/v1/uploads?name=a.mp4\n\n\n\n",
      "POST\n/api/v1/project\n\n\n\n",
      "GET\n/api/v1/session\n\n\n\n",
      "POST\n/api/v1/session\n\n\n\n{\"name\": \"ann\", \"password\": \"correct horse\"}",
      "POST\n/api/v1/session/end\n\n\n\n{}",
      "GET\n/api/v1/audit?limit=5&before=9\n\n\n\n",
      std::string("GET\n/api/v1/project\n\na=b; victorious_80=") + kSession + "\n\n",
      std::string("PUT\n/api/v1/objects/1/review\n\nvictorious_80=") + kSession + "; c\n\n{\"verdict\": \"accepted\"}",
      std::string("GET\n/api/v1/objects/1\n\n\nBearer ") + kToken + "\n",
      std::string("GET\n/api/v1/audit\n\n\nBearer ") + kToken + "\n"};
}

// Who may do what: every route for every role, sessions, tokens, log-ins.
#include "victorious/apps/serve/access_control.h"

#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "testing/data.h"
#include "victorious/apps/serve/access_log.h"
#include "victorious/apps/serve/api.h"
#include "victorious/apps/serve/secret.h"
#include "victorious/base/folder.h"
#include "victorious/base/utc.h"
#include "victorious/store/sqlite/connection.h"

namespace victorious {
namespace {

using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;
using ::testing::StartsWith;

constexpr int kOpenPort = 8080;
constexpr std::int64_t kHour = 3'600'000'000;
const std::string kPassword = "correct horse battery";

std::string_view NameOf(HttpMethod method) {
  if (method == HttpMethod::kPut) return "PUT";
  if (method == HttpMethod::kPost) return "POST";
  return method == HttpMethod::kDelete ? "DELETE" : "GET";
}

// A secret of the right form.
std::string SecretOf(const std::string& name) { return name + std::string(43 - name.size(), '_'); }

std::string HeaderOf(const HttpResponse& response, std::string_view name) {
  for (const auto& [header, value] : response.headers) {
    if (header == name) return value;
  }
  return "";
}

// An index with one object. Accounts are added by AddAccounts.
class AccessTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto store = OpenSqliteStore(index_, StoreMode::kCreate).value();
    const auto video = store->PutVideo({.content_id = "c", .name = "none.mp4", .width = 640, .height = 480}).value();
    const auto model = store->PutModel({.name = "jeep", .content_id = "m", .kind = ModelKind::kCad}).value();
    IndexBatch batch;
    batch.tracklets.push_back({std::nullopt, {.video = video.id, .model = model.id, .score = 0.5, .frames = 1}});
    batch.sightings.push_back({0, {.box = {1, 2, 30, 40}, .score = 0.5, .matches = 9}});
    ASSERT_TRUE(store->Commit(batch));
    accounts_ = OpenAccountStore(index_, StoreMode::kCreate).value();
  }

  void Open(ServerIdentity server = {}, const std::function<void(ApiOptions&)>& change = [](ApiOptions&) {}) {
    api_.reset();
    std::filesystem::create_directories(folder_ / "models");
    ApiOptions options{.index = index_,
                       .models = folder_ / "models",
                       .telemetry = {},
                       .web = {},
                       .uploads = folder_ / "uploads",
                       .server = server};
    change(options);
    auto api = Api::Open(std::move(options), cancel_);
    ASSERT_TRUE(api) << api.error().message;
    api_ = *std::move(api);
  }

  // Accounts "viewer", "analyst" and "admin", each with a session whose secret is SecretOf(name).
  void AddAccounts() {
    const std::string hash = HashPassword(kPassword).value();
    for (const Role role : {Role::kViewer, Role::kAnalyst, Role::kAdmin}) {
      const std::string name(ToText(role));
      const Account account = accounts_->Add(name, role, hash, 1).value();
      ASSERT_TRUE(accounts_->AddCredential({.account = account.id,
                                            .kind = CredentialKind::kSession,
                                            .digest = DigestSecret(SecretOf(name)),
                                            .label = "",
                                            .now_us = NowUtcMicroseconds(),
                                            .lifetime_us = kHour}));
    }
  }

  HttpResponse Send(HttpRequest request) {
    if (request.host.empty()) request.host = "127.0.0.1:8080";
    if (request.client.empty()) request.client = "127.0.0.1";
    if (request.content_type.empty()) request.content_type = "application/json";
    return api_->Handle(request, kOpenPort);
  }

  // A request with the session of an account; empty: without.
  HttpResponse SendAs(const std::string& account, HttpRequest request) {
    if (!account.empty()) request.cookie = "other=1; victorious_8080=" + SecretOf(account);
    return Send(std::move(request));
  }

  HttpResponse LogIn(const std::string& name, const std::string& password) {
    return Send({.method = HttpMethod::kPost,
                 .target = "/api/v1/session",
                 .body = json({{"name", name}, {"password", password}}).dump()});
  }

  testing::ScratchFolder folder_;
  std::filesystem::path index_ = folder_ / "index.db";
  CancelToken cancel_;
  std::unique_ptr<AccountStore> accounts_;
  std::unique_ptr<Api> api_;
};

TEST_F(AccessTest, TheTableHasEveryDescribedRoute) {
  Open();
  std::ifstream file(VICTORIOUS_API_DESCRIPTION);
  const json description = json::parse(file);
  std::set<std::string> described;
  for (const auto& [path, item] : description["paths"].items()) {
    for (const auto& [method, operation] : item.items()) {
      if (method == "get") described.insert("GET " + path);
      if (method == "put") described.insert("PUT " + path);
      if (method == "post") described.insert("POST " + path);
      if (method == "delete") described.insert("DELETE " + path);
    }
  }
  std::set<std::string> routes;
  for (const ApiRoute& route : api_->routes())
    routes.insert(std::string(NameOf(route.method)) + " " + std::string(route.path));
  EXPECT_EQ(routes, described);
}

TEST_F(AccessTest, EveryRouteAsksForItsRole) {
  AddAccounts();
  Open();
  for (const ApiRoute& route : api_->routes()) {
    HttpRequest request{.method = route.method, .body = "{}"};
    for (const char c : route.path) {
      if (request.target.find('{') == std::string::npos || c != '}') request.target += c;
      if (c == '}') request.target.replace(request.target.find('{'), std::string::npos, "1");
    }
    for (const std::string account : {"", "viewer", "analyst", "admin"}) {
      const bool is_log_out = route.path.ends_with("/end");
      if (is_log_out && !account.empty()) continue;  // ends the session: LogOutEndsTheSession
      const auto role = FromText(kRoleTexts, account);
      const int status = SendAs(account, request).status;
      const std::string what = std::string(NameOf(route.method)) + " " + request.target + " by " + account;
      const bool may = !route.least || (role && *role >= *route.least);
      if (may) {
        EXPECT_THAT(status, ::testing::AllOf(Not(401), Not(403), Not(405))) << what;
      } else {
        EXPECT_EQ(status, role ? 403 : 401) << what;
      }
    }
  }
  for (const auto& [account, status] : {std::pair("", 401), std::pair("viewer", 403), std::pair("analyst", 200)}) {
    HttpRequest upload{.method = HttpMethod::kPost,
                       .target = "/api/v1/uploads?name=a.mp4",
                       .host = "127.0.0.1:8080",
                       .content_type = "application/octet-stream"};
    if (*account != 0) upload.cookie = "victorious_8080=" + SecretOf(account);
    const auto plan = api_->PlanUpload(upload, kOpenPort);
    EXPECT_EQ(plan ? 200 : plan.error().status, status) << account << ": refused before the body is read";
  }
}

TEST_F(AccessTest, RequestsWithoutARouteAreRefused) {
  AddAccounts();
  Open();
  for (const std::string target : {"/api", "/api/v1", "/api/v2/project", "/api/v1/projects", "/api/v1/videos/1/file/x",
                                   "/api/v1/session/x", "/api/v1/objects/1/review/2"}) {
    EXPECT_EQ(SendAs("admin", {.target = target}).status, 404) << target;
  }
  const HttpResponse refused = SendAs("admin", {.method = HttpMethod::kPut, .target = "/api/v1/jobs"});
  EXPECT_EQ(refused.status, 405);
  EXPECT_EQ(HeaderOf(refused, "Allow"), "GET, HEAD, POST");
  EXPECT_EQ(SendAs("admin", {.method = HttpMethod::kOther, .target = "/api/v1/project"}).status, 405);
}

TEST_F(AccessTest, HealthIsForEverybodyAndSaysNothingElse) {
  AddAccounts();
  Open();
  const HttpResponse well = Send({.target = "/healthz"});
  EXPECT_EQ(well.status, 200);
  EXPECT_EQ(well.body, "ok\n");
  const auto connection = sqlite::Connection::Open(index_, sqlite::Access::kWrite).value();
  ASSERT_TRUE(connection->Execute("ALTER TABLE accounts RENAME TO gone"));
  const HttpResponse ill = Send({.target = "/healthz"});
  EXPECT_EQ(ill.status, 503);
  EXPECT_EQ(ill.body, "not ok\n");
  EXPECT_EQ(SendAs("admin", {.target = "/healthz"}).body, "not ok\n");
}

TEST_F(AccessTest, MetricsAreForAdministratorsAndNameRoutesNotRequests) {
  AddAccounts();
  Open();
  EXPECT_EQ(Send({.target = "/metrics"}).status, 401);
  EXPECT_EQ(SendAs("viewer", {.target = "/metrics"}).status, 403);
  EXPECT_EQ(SendAs("viewer", {.target = "/api/v1/objects/987654"}).status, 404);
  EXPECT_EQ(SendAs("viewer", {.target = "/api/v1/objects/987653"}).status, 404);
  // A slow answer that nobody has made yet.
  HttpRequest frame{.target = "/api/v1/videos/1/frames/0", .host = "127.0.0.1:8080"};
  frame.cookie = "victorious_8080=" + SecretOf("viewer");
  HttpResponse slow = api_->Begin(frame, kOpenPort);
  ASSERT_TRUE(slow.slow);
  const HttpResponse answer = SendAs("admin", {.target = "/metrics"});
  EXPECT_EQ(answer.status, 200);
  EXPECT_THAT(answer.content_type, StartsWith("text/plain; version=0.0.4"));
  for (const char* const line :
       {"victorious_http_requests_total{route=\"/api/v1/objects/{id}\",method=\"GET\",status=\"404\"} 2\n",
        "victorious_http_requests_total{route=\"refused\",method=\"GET\",status=\"403\"} 1\n",
        "victorious_http_request_duration_seconds_bucket{group=\"quick\",le=\"+Inf\"} 2\n",
        "victorious_http_request_duration_seconds_count{group=\"refused\"} 2\n",
        "victorious_decodings{state=\"waiting\"} 1\n", "victorious_jobs{state=\"queued\"} 0\n",
        "victorious_sessions 3\n"}) {
    EXPECT_THAT(answer.body, HasSubstr(line));
  }
  EXPECT_THAT(answer.body, Not(HasSubstr("98765")));
  EXPECT_THAT(answer.body, Not(HasSubstr("none.mp4")));
  slow.slow.reset();
  EXPECT_THAT(SendAs("admin", {.target = "/metrics"}).body, HasSubstr("victorious_decodings{state=\"waiting\"} 0\n"));
}

TEST_F(AccessTest, ReadsAreInTheLogWithTheirAccount) {
  AddAccounts();
  const std::filesystem::path log = folder_ / "access.jsonl";
  Open({}, [&](ApiOptions& options) { options.access_log = log; });
  EXPECT_EQ(SendAs("viewer", {.target = "/api/v1/objects?limit=5"}).status, 200);
  EXPECT_EQ(SendAs("viewer", {.target = "/api/v1/objects/987654"}).status, 404);
  EXPECT_EQ(SendAs("viewer", {.target = "/api/v1/jobs"}).status, 200);
  EXPECT_EQ(Send({.target = "/api/v1/objects"}).status, 401);
  EXPECT_EQ(SendAs("admin", {.target = "/api/v1/videos/1"}).status, 200);
  std::ifstream file(log);
  std::vector<json> lines;
  for (std::string line; std::getline(file, line);) lines.push_back(json::parse(line));
  ASSERT_THAT(lines, SizeIs(3)) << "the head, and what was shown";
  EXPECT_EQ(lines[1]["actor"], "viewer");
  EXPECT_EQ(lines[1]["target"], "/api/v1/objects?limit=5");
  EXPECT_EQ(lines[1]["client"], "127.0.0.1");
  EXPECT_EQ(lines[2]["actor"], "admin");
  EXPECT_EQ(lines[2]["target"], "/api/v1/videos/1");
  EXPECT_EQ(VerifyAccessLog(log)->entries, 2);
}

TEST_F(AccessTest, WithoutAccountsThisMachineIsOpen) {
  Open();
  EXPECT_EQ(Send({.target = "/api/v1/project"}).status, 200);
  EXPECT_EQ(Send({.target = "/api/v1/audit"}).status, 200);
  EXPECT_EQ(json::parse(Send({.target = "/api/v1/session"}).body),
            json({{"has_accounts", false}, {"account", nullptr}}));
  AddAccounts();
  EXPECT_EQ(Send({.target = "/api/v1/project"}).status, 401) << "from the first account on";
  EXPECT_EQ(SendAs("viewer", {.target = "/api/v1/project"}).status, 200);
  for (const std::string name : {"viewer", "analyst", "admin"}) ASSERT_TRUE(accounts_->Remove(name));
  EXPECT_EQ(Send({.target = "/api/v1/project"}).status, 401) << "removing the last account opens nothing";
  EXPECT_EQ(SendAs("viewer", {.target = "/api/v1/project"}).status, 401);
}

TEST_F(AccessTest, OtherAddressesNeedAnAccount) {
  const ServerIdentity outside{.is_loopback = false, .has_tls = true};
  const auto refused =
      Api::Open({.index = index_, .models = {}, .telemetry = {}, .web = {}, .uploads = {}, .server = outside}, cancel_);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(refused.error().message, HasSubstr("victorious user add"));
  AddAccounts();
  Open(outside);
  HttpRequest request{.target = "/api/v1/project", .host = "search.example:8080"};
  EXPECT_EQ(Send(request).status, 401);
  request.cookie = "__Host-victorious_8080=" + SecretOf("viewer");
  EXPECT_EQ(Send(request).status, 200);
  request.origin = "https://search.example:8080";
  EXPECT_EQ(Send(request).status, 200);
  for (const std::string origin :
       {"http://search.example:8080", "https://search.example", "https://other.example:8080", "null"}) {
    request.origin = origin;
    EXPECT_EQ(Send(request).status, 403) << origin;
  }
}

TEST_F(AccessTest, LogInGivesASessionThatScriptsDoNotSee) {
  AddAccounts();
  Open();
  const HttpResponse answer = LogIn("Analyst", kPassword);
  ASSERT_EQ(answer.status, 200) << answer.body;
  EXPECT_EQ(json::parse(answer.body)["account"], json({{"name", "analyst"}, {"role", "analyst"}}));
  const std::string cookie = HeaderOf(answer, "Set-Cookie");
  EXPECT_THAT(cookie, HasSubstr("; HttpOnly; SameSite=Strict; Max-Age=43200"));
  EXPECT_THAT(cookie, Not(HasSubstr("Secure")));
  HttpRequest request{.target = "/api/v1/session"};
  request.cookie = cookie.substr(0, cookie.find(';'));
  EXPECT_EQ(json::parse(Send(request).body)["account"]["name"], "analyst");
  EXPECT_EQ(Send({.target = "/api/v1/project", .authorization = "Bearer " + request.cookie.substr(16)}).status, 401)
      << "a session is no token";

  request.method = HttpMethod::kPost;
  request.target = "/api/v1/session/end";
  const HttpResponse ended = Send(request);
  EXPECT_EQ(ended.status, 200);
  EXPECT_THAT(HeaderOf(ended, "Set-Cookie"), StartsWith("victorious_8080=; Path=/"));
  EXPECT_THAT(HeaderOf(ended, "Set-Cookie"), HasSubstr("Max-Age=0"));
  EXPECT_EQ(Send({.target = "/api/v1/project", .cookie = request.cookie}).status, 401) << "the session has ended";
}

TEST_F(AccessTest, CookiesOfTlsAreSecure) {
  AddAccounts();
  Open({.is_loopback = true, .has_tls = true});
  const std::string cookie = HeaderOf(LogIn("admin", kPassword), "Set-Cookie");
  EXPECT_THAT(cookie, StartsWith("__Host-victorious_8080="));
  EXPECT_THAT(cookie, HasSubstr("; Secure"));
}

TEST_F(AccessTest, WrongLogInsGetOneAnswerAndAreInTheLog) {
  AddAccounts();
  Open();
  EXPECT_EQ(LogIn("admin", "correct horse batterx").body, LogIn("nobody", kPassword).body)
      << "which names exist is not told";
  EXPECT_EQ(LogIn("admin", "").status, 401);
  EXPECT_EQ(LogIn("a b'; DROP TABLE accounts", kPassword).status, 401);
  for (const std::string body : {"", "[]", "{}", "{\"name\": 1, \"password\": \"x\"}", "{\"name\": \"admin\"}"}) {
    EXPECT_EQ(Send({.method = HttpMethod::kPost, .target = "/api/v1/session", .body = body}).status, 400) << body;
  }
  EXPECT_EQ(LogIn("viewer", kPassword).status, 200) << "another account";

  const json log = json::parse(SendAs("admin", {.target = "/api/v1/audit?limit=3"}).body)["entries"];
  ASSERT_EQ(log.size(), 3U);
  EXPECT_EQ(log[0]["actor"], "viewer");
  EXPECT_EQ(log[0]["action"], "log_in");
  EXPECT_EQ(log[0]["detail"]["client"], "127.0.0.1");
  EXPECT_EQ(log[1]["action"], "log_in_refused");
  EXPECT_EQ(log[1]["subject"], "account admin");
  EXPECT_EQ(SendAs("admin", {.target = "/api/v1/audit?limit=0"}).status, 400);
  const std::string before = std::to_string(log[1]["id"].get<std::int64_t>());
  const json older = json::parse(SendAs("admin", {.target = "/api/v1/audit?before=" + before}).body)["entries"];
  EXPECT_EQ(older.back()["action"], "log_in_refused");
  EXPECT_THAT(older.dump(), HasSubstr("an unknown account"));
  EXPECT_THAT(older.dump(), Not(HasSubstr("nobody"))) << "it could be a password in the wrong field";
}

TEST_F(AccessTest, LogInsThatFailAreLimited) {
  AddAccounts();
  std::int64_t now_us = 0;
  const auto access = AccessControl::Open(index_, /*can_write=*/true, {}, [&] { return now_us; }).value();
  const auto log_in = [&](const std::string& name, const std::string& password) {
    return access
        ->LogIn({.client = "127.0.0.1", .body = json({{"name", name}, {"password", password}}).dump()}, kOpenPort)
        .value();
  };
  for (int i = 0; i < 10; ++i) EXPECT_EQ(log_in("admin", "wrong password").status, 401) << i;
  EXPECT_EQ(log_in("admin", "wrong password").status, 429);
  const HttpResponse late = log_in("admin", kPassword);
  EXPECT_EQ(late.status, 429) << "the right password, too: it could be a guess";
  EXPECT_EQ(HeaderOf(late, "Retry-After"), "60");
  EXPECT_EQ(log_in("viewer", kPassword).status, 200) << "another account";
  now_us = 60'000'000;
  EXPECT_EQ(log_in("admin", kPassword).status, 200);
}

TEST_F(AccessTest, SessionsEndByAClockThatNobodySets) {
  AddAccounts();  // with sessions of an hour
  std::int64_t now_us = 7;
  const auto access = AccessControl::Open(index_, /*can_write=*/true, {}, [&] { return now_us; }).value();
  HttpRequest request{.method = HttpMethod::kGet, .target = "/api/v1/project"};
  request.cookie = "victorious_8080=" + SecretOf("viewer");
  EXPECT_TRUE(access->Admit(request, Role::kViewer, kOpenPort));
  now_us += 2 * kHour;
  EXPECT_FALSE(access->Admit(request, Role::kViewer, kOpenPort));
  const auto logged_in = access->LogIn(
      {.client = "127.0.0.1", .body = json({{"name", "viewer"}, {"password", kPassword}}).dump()}, kOpenPort);
  ASSERT_TRUE(logged_in);
  const std::string cookie(HeaderOf(*logged_in, "Set-Cookie"));
  request.cookie = cookie.substr(0, cookie.find(';'));
  EXPECT_TRUE(access->Admit(request, Role::kViewer, kOpenPort));
}

TEST_F(AccessTest, NobodyLogsInToAnIndexThatCannotBeWritten) {
  const auto access = AccessControl::Open(index_, /*can_write=*/false, {}).value();
  AddAccounts();  // by another process
  const auto refused = access->LogIn(
      {.client = "127.0.0.1", .body = json({{"name", "admin"}, {"password", kPassword}}).dump()}, kOpenPort);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().error.code, ErrorCode::kPermissionDenied);
  EXPECT_THAT(refused.error().error.message, HasSubstr("cannot be written"));
  HttpRequest request{.method = HttpMethod::kPost, .target = "/api/v1/session/end"};
  request.cookie = "victorious_8080=" + SecretOf("admin");
  const auto caller = access->Admit(request, Role::kViewer, kOpenPort);
  ASSERT_TRUE(caller);
  const auto ended = access->LogOut(*caller, kOpenPort);
  ASSERT_TRUE(ended);
  EXPECT_THAT(HeaderOf(*ended, "Set-Cookie"), HasSubstr("Max-Age=0"));
}

TEST_F(AccessTest, TokensAreForScripts) {
  AddAccounts();
  Open();
  const std::int64_t analyst = (*accounts_->Find("analyst"))->id;
  const std::string good = SecretOf("token");
  const std::string old = SecretOf("old");
  const std::int64_t now = NowUtcMicroseconds();
  ASSERT_TRUE(accounts_->AddCredential({.account = analyst,
                                        .kind = CredentialKind::kToken,
                                        .digest = DigestSecret(good),
                                        .label = "nightly",
                                        .now_us = now,
                                        .lifetime_us = kHour}));
  ASSERT_TRUE(accounts_->AddCredential({.account = analyst,
                                        .kind = CredentialKind::kToken,
                                        .digest = DigestSecret(old),
                                        .label = "",
                                        .now_us = now - kHour,
                                        .lifetime_us = kHour}));
  const auto status = [&](const std::string& authorization) {
    return Send({.target = "/api/v1/project", .authorization = authorization}).status;
  };
  EXPECT_EQ(status("Bearer " + good), 200);
  const std::vector<std::string> all_wrong = {"Bearer " + old,
                                              "Bearer " + SecretOf("x"),
                                              good,
                                              "Basic " + good,
                                              "Bearer",
                                              "Bearer ",
                                              "Bearer " + good + " ",
                                              "bearer\t" + good,
                                              "Bearer " + std::string(9000, 'a')};
  for (const std::string& wrong : all_wrong) {
    EXPECT_EQ(status(wrong), 401) << wrong;
  }
  HttpRequest both{.target = "/api/v1/project", .authorization = "Bearer " + SecretOf("x")};
  EXPECT_EQ(SendAs("admin", both).status, 401) << "a wrong token is not helped by a session";
  EXPECT_EQ(Send({.target = "/api/v1/project", .cookie = "victorious_8080=" + good}).status, 401)
      << "a token is no session";
}

TEST_F(AccessTest, ReviewsHaveTheNameOfTheAccount) {
  AddAccounts();
  Open();
  const HttpRequest review{.method = HttpMethod::kPut,
                           .target = "/api/v1/objects/1/review",
                           .body = R"({"verdict": "accepted", "note": "", "reviewer": "somebody else"})"};
  EXPECT_EQ(SendAs("viewer", review).status, 403);
  const HttpResponse answer = SendAs("analyst", review);
  ASSERT_EQ(answer.status, 200) << answer.body;
  EXPECT_EQ(json::parse(answer.body)["review"]["reviewer"], "analyst");
  const json log = json::parse(SendAs("admin", {.target = "/api/v1/audit"}).body)["entries"];
  EXPECT_EQ(log[0]["actor"], "analyst");
  EXPECT_EQ(log[0]["detail"]["verdict"], "accepted");
  EXPECT_EQ(json::parse(SendAs("viewer", {.target = "/api/v1/project"}).body)["can_review"], false);
  EXPECT_EQ(json::parse(SendAs("viewer", {.target = "/api/v1/project"}).body)["has_jobs"], false);
  EXPECT_EQ(json::parse(SendAs("analyst", {.target = "/api/v1/project"}).body)["can_review"], true);
}

TEST_F(AccessTest, UploadsAndJobsHaveLimits) {
  AddAccounts();
  Open({}, [](ApiOptions& options) {
    options.max_uploads = 5;  // one an account
    options.max_jobs = 0;
  });
  const auto plan = [&](const std::string& account) {
    HttpRequest request{.method = HttpMethod::kPost, .target = "/api/v1/uploads?name=a.mp4"};
    request.host = "127.0.0.1:8080";
    request.content_type = "application/octet-stream";
    request.authorization = "";
    request.cookie = "victorious_8080=" + SecretOf(account);
    const auto planned = api_->PlanUpload(request, kOpenPort);
    return planned ? 200 : planned.error().status;
  };
  EXPECT_EQ(plan("analyst"), 200);
  EXPECT_EQ(plan("analyst"), 409);
  EXPECT_EQ(plan("admin"), 200) << "another account has its own";
  const auto day_before = std::filesystem::file_time_type::clock::now() - std::chrono::hours(25);
  const std::filesystem::path uploads = folder_ / "uploads";
  const std::vector<std::filesystem::path> unused = ListFolder(uploads).value();
  for (const std::filesystem::path& upload : unused) std::filesystem::last_write_time(upload, day_before);
  EXPECT_EQ(plan("analyst"), 200) << "what nobody used is removed";
  EXPECT_THAT(ListFolder(uploads).value(), SizeIs(1));

  std::ofstream(folder_ / "models" / "jeep.vmodel") << "a model, as far as the library lists it";
  const auto submit = [&](const std::string& url) {
    return SendAs(
        "admin",
        {.method = HttpMethod::kPost, .target = "/api/v1/jobs", .body = json({{"kind", "live"}, {"url", url}}).dump()});
  };
  EXPECT_THAT(submit("rtsp://192.0.2.1/a").body, HasSubstr("0 open jobs"));
  for (const char* const url : {"rtsp://127.0.0.1:22/", "rtsp://169.254.169.254/", "rtsp://localhost/"}) {
    EXPECT_EQ(submit(url).status, 403) << url;
  }
}

TEST(FindCookieTest, ReadsAnyHeader) {
  EXPECT_EQ(FindCookie("a=1; victorious_8080=xyz; b=2", "victorious_8080"), "xyz");
  EXPECT_EQ(FindCookie("victorious_8080=x=y", "victorious_8080"), "x=y");
  EXPECT_EQ(FindCookie(" \tvictorious_8080=x \t", "victorious_8080"), "x");
  for (const std::string header :
       {"", ";", ";;;", "=", "victorious_8080", "victorious_80800=x", "Victorious_8080=x", "xvictorious_8080=y"}) {
    EXPECT_EQ(FindCookie(header, "victorious_8080"), "") << header;
  }
}

}  // namespace
}  // namespace victorious

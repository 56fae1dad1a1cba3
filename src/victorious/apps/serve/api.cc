#include "victorious/apps/serve/api.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <new>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "victorious/apps/serve/access_control.h"
#include "victorious/apps/serve/access_log.h"
#include "victorious/apps/serve/api_response.h"
#include "victorious/apps/serve/api_routes.h"
#include "victorious/apps/serve/request_guard.h"
#include "victorious/apps/serve/server_metrics.h"
#include "victorious/apps/serve/static_files.h"
#include "victorious/base/isolated_process.h"
#include "victorious/base/log.h"
#include "victorious/base/one_line.h"
#include "victorious/base/utc.h"
#include "victorious/base/without_folders.h"
#include "victorious/input/video/trusted_certificates.h"
#include "victorious/object/model/model_library.h"
#include "victorious/store/open_store.h"

namespace victorious {
namespace {

HttpResponse MethodNotAllowed(std::string_view allowed) {
  HttpResponse response = ErrorResponse(405, "method_not_allowed", fmt::format("only {} is answered here", allowed));
  response.headers.emplace_back("Allow", allowed);
  return response;
}

bool IsRead(const HttpRequest& request) {
  return request.method == HttpMethod::kGet || request.method == HttpMethod::kHead;
}

// The files that may be opened where the index names them.
FileRoots RootsOf(const ApiOptions& options) {
  std::vector<std::filesystem::path> roots = options.videos;
  std::vector<std::filesystem::path> secrets = options.secrets;
  if (!options.access_log.empty()) secrets.push_back(options.access_log);
  roots.push_back(options.uploads);
  roots.push_back(options.copies);
  if (options.telemetry) roots.emplace_back(*options.telemetry);
  // A service that nobody gave a folder runs in "/", below which everything lies.
  std::error_code unknown;
  const std::filesystem::path current = std::filesystem::current_path(unknown);
  if (current != current.root_path()) roots.push_back(current);
  if (!IsDatabaseUrl(options.index)) {
    const std::filesystem::path index = std::filesystem::absolute(options.index, unknown);
    roots.push_back(index.parent_path());
    for (const char* of_sqlite : {"", "-wal", "-shm", "-journal"}) secrets.emplace_back(index.string() + of_sqlite);
  }
  return FileRoots(roots, secrets);
}

bool IsOfApi(std::span<const std::string> segments) {
  return !segments.empty() && (segments.front() == "api" ||
                               (segments.size() == 1 && (segments[0] == "healthz" || segments[0] == "metrics")));
}

using Clock = std::chrono::steady_clock;

constexpr std::array<std::string_view, 6> kLoggedPaths = {"/api/v1/videos", "/api/v1/objects",         "/api/v1/tiles",
                                                          "/api/v1/models", "/api/v1/jobs/{id}/files", "/api/v1/audit"};

// Whether who asks for it reads what was found or filmed. Streams of events, the queue and the server's own state are
// asked for by the page itself, again and again.
bool IsLogged(const ApiRoute* route) {
  if (route == nullptr || route->method != HttpMethod::kGet) return false;
  return std::ranges::any_of(kLoggedPaths, [&](std::string_view path) { return route->path.starts_with(path); });
}

// Whether the JSON of a route names files. Where users' notes are, they stay as they are.
bool NamesFiles(const ApiRoute* route) {
  constexpr std::array<std::string_view, 4> kPaths = {"/api/v1/videos", "/api/v1/videos/{id}",
                                                      "/api/v1/videos/{id}/camera", "/api/v1/cluster"};
  return route != nullptr && std::ranges::find(kPaths, route->path) != kPaths.end();
}

// The telemetry of the only video. Error: kInvalidArgument if the index has another number of videos.
Expected<std::optional<GivenTelemetryFile>> GivenTelemetry(const ApiOptions& options, IndexView& index) {
  if (!options.telemetry) return std::nullopt;
  VICTORIOUS_ASSIGN_OR_RETURN(const auto lists, index.Lists());
  if (lists->videos.size() == 1) return GivenTelemetryFile{lists->videos.front().id, *options.telemetry};
  return Fail(ErrorCode::kInvalidArgument,
              fmt::format("--telemetry: the index has {} videos, and the file belongs to one of them: name it "
                          "VIDEO.telemetry.csv beside its video, where it is found without the flag",
                          lists->videos.size()));
}

}  // namespace

struct Api::Parts {
  Parts(ApiOptions given, std::unique_ptr<IndexView> view, std::unique_ptr<AccessControl> control,
        std::optional<GivenTelemetryFile> telemetry, std::unique_ptr<AccessLog> log)
      : options(std::move(given)),
        access_log(std::move(log)),
        index(std::move(view)),
        access(std::move(control)),
        roots(RootsOf(options), IsDatabaseUrl(options.index) ? "" : options.index, std::move(telemetry)),
        videos(roots),
        copies(options.copies, {.max_bytes = options.max_copies_bytes}),
        uploads(options.uploads),
        page(options.web) {}

  [[nodiscard]] JobFolders Folders() const;
  /// Makes the routes. Call it once, when `live` is there.
  void MakeTable(std::unique_ptr<ThresholdStore> thresholds);

  const ApiOptions options;
  const std::unique_ptr<AccessLog> access_log;  ///< null: none
  const std::unique_ptr<IndexView> index;
  const std::unique_ptr<AccessControl> access;
  const VideoRoots roots;
  VideoFiles videos;
  CopyFolder copies;
  UploadFolder uploads;
  StaticFiles page;
  const std::shared_ptr<ServerMetrics> metrics = std::make_shared<ServerMetrics>();
  std::unique_ptr<LiveService> live;  ///< its threads use the index and the copies
  std::unique_ptr<RouteParts> routes;
  RouteTable table{{}};
};

JobFolders Api::Parts::Folders() const {
  const SampleFiles sample = options.sample.value_or(SampleFiles{});
  return {.index = options.index,
          .models = options.models,
          .copies = options.copies,
          .categories = options.categories,
          .files = roots.files(),
          .uploads = options.uploads,
          .sample_scene = sample.scene,
          .sample_object = sample.object,
          .certificates = TrustedCertificates()};
}

void Api::Parts::MakeTable(std::unique_ptr<ThresholdStore> thresholds) {
  routes = std::make_unique<RouteParts>(SharedByRoutes{.options = options,
                                                       .index = *index,
                                                       .access = *access,
                                                       .live = *live,
                                                       .videos = videos,
                                                       .copies = copies,
                                                       .uploads = uploads,
                                                       .metrics = metrics},
                                        std::move(thresholds));
  table = RouteTable(MakeRoutes(*routes));
}

Api::Api(std::unique_ptr<Parts> parts, const CancelToken& cancel) : cancel_(cancel), parts_(std::move(parts)) {}

Api::~Api() = default;

Expected<std::unique_ptr<Api>> Api::Open(ApiOptions options, const CancelToken& cancel) {
  VICTORIOUS_ASSIGN_OR_RETURN([[maybe_unused]] const std::filesystem::path decoder, DecoderProgram());
  if (!options.models.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN([[maybe_unused]] const auto names, ModelLibrary(options.models).Names());
  }
  VICTORIOUS_ASSIGN_OR_RETURN(std::unique_ptr<IndexView> index, IndexView::Open(options.index));
  VICTORIOUS_ASSIGN_OR_RETURN(auto telemetry, GivenTelemetry(options, *index));
  VICTORIOUS_ASSIGN_OR_RETURN(auto access, AccessControl::Open(options.index, index->can_review(), options.server));
  VICTORIOUS_ASSIGN_OR_RETURN(
      auto thresholds, OpenThresholdStore(options.index, index->can_review() ? StoreMode::kCreate : StoreMode::kRead));
  std::unique_ptr<AccessLog> log;
  if (!options.access_log.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(log, AccessLog::Open(options.access_log));
  }
  auto parts = std::make_unique<Parts>(std::move(options), std::move(index), std::move(access), std::move(telemetry),
                                       std::move(log));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto lists, parts->index->Lists());
  if (const std::string outside = parts->roots.DescribeOutside(lists->videos); !outside.empty()) LogWarning(outside);
  VICTORIOUS_ASSIGN_OR_RETURN(parts->live, LiveService::Start(*parts->index, parts->copies, parts->Folders()));
  parts->MakeTable(std::move(thresholds));
  return std::unique_ptr<Api>(new Api(std::move(parts), cancel));
}

std::span<const ApiRoute> Api::routes() const { return parts_->table.routes(); }

HttpResponse Api::Handle(const HttpRequest& request, int port) {
  const auto begun = Clock::now();
  auto admitted = Admit(request, port);
  if (!admitted) return Refused(request, std::move(admitted).error(), begun);
  return Answer(request, *admitted, port, cancel_, begun);
}

HttpResponse Api::Begin(const HttpRequest& request, int port) {
  const auto begun = Clock::now();
  auto admitted = Admit(request, port);
  if (!admitted) return Refused(request, std::move(admitted).error(), begun);
  const ApiRoute* route = admitted->match.route;
  if (route == nullptr || !route->is_slow) return Answer(request, *admitted, port, cancel_, begun);
  const std::string client = request.client + " " + admitted->caller.name();
  HttpResponse response;
  response.slow = std::make_shared<SlowResponse>(SlowResponse{
      .client = client,
      .make = [this, request, admitted = *std::move(admitted), port, begun,
               decoding = std::make_shared<ServerMetrics::Decoding>(parts_->metrics)](const CancelToken& left) {
        decoding->Start();
        return Answer(request, admitted, port, left, begun);
      }});
  return response;
}

HttpResponse Api::Refused(const HttpRequest& request, HttpResponse refusal, Clock::time_point begun) {
  parts_->metrics->Count(ServerMetrics::Group::kRefused, request.method, "refused", refusal.status,
                         Clock::now() - begun);
  return refusal;
}

HttpResponse Api::Answer(const HttpRequest& request, const Admitted& admitted, int port, const CancelToken& cancel,
                         Clock::time_point begun) {
  HttpResponse response = Make(request, admitted, port, cancel);
  response = Logged(request, admitted, std::move(response));
  const ApiRoute* route = admitted.match.route;
  using Group = ServerMetrics::Group;
  const Group group = route == nullptr ? Group::kPageFile : route->is_slow ? Group::kSlow : Group::kQuick;
  parts_->metrics->Count(group, request.method, route == nullptr ? "page" : route->path, response.status,
                         Clock::now() - begun);
  return response;
}

HttpResponse Api::Logged(const HttpRequest& request, const Admitted& admitted, HttpResponse response) {
  if (!parts_->access_log || !IsLogged(admitted.match.route) || response.status >= 400) return response;
  const Status logged = parts_->access_log->Append({.time_utc_us = NowUtcMicroseconds(),
                                                    .actor = admitted.caller.name(),
                                                    .client = request.client,
                                                    .target = request.target,
                                                    .status = response.status});
  if (logged) return response;
  LogError("the log of reads: " + OneLine(logged.error().message));
  return ErrorResponse(503, Name(ErrorCode::kUnavailable),
                       "the server cannot write its log of reads, without which it shows nothing");
}

HttpResponse Api::Make(const HttpRequest& request, const Admitted& admitted, int port, const CancelToken& cancel) {
  try {
    auto answer = AskHandler(request, admitted, port, cancel);
    const bool hides_folders = !admitted.caller.May(Role::kAdmin);
    if (!answer && hides_folders) answer.error().error.message = WithoutFolders(answer.error().error.message);
    HttpResponse response = answer ? *std::move(answer) : ErrorResponse(answer.error());
    if (!answer && response.status == 503) response.headers.emplace_back("Retry-After", kRetryAfter_s);
    if (hides_folders && NamesFiles(admitted.match.route)) response.body = WithoutFolders(response.body);
    // Age says what it says in caches (RFC 9111): for so long, nobody looked whether the answer holds.
    const auto age = parts_->index->ListsAge();
    if (admitted.match.route != nullptr && age.count() > 0) {
      response.headers.emplace_back("Age", std::to_string(age.count()));
    }
    return response;
  } catch (const std::bad_alloc&) {
    return ErrorResponse(ApiError(Error{ErrorCode::kUnavailable, "the server is out of memory: ask again later"}));
  }
}

std::expected<Api::Admitted, HttpResponse> Api::Admit(const HttpRequest& request, int port) {
  auto target = ParseRequestTarget(request.target);
  const bool is_of_api = !target || IsOfApi(target->segments);
  if (auto refusal = RefuseForeign(request, is_of_api, parts_->options.server, port)) {
    return std::unexpected(*std::move(refusal));
  }
  if (!target) return std::unexpected(ErrorResponse(target.error()));
  if (!IsOfApi(target->segments)) {
    if (!IsRead(request)) return std::unexpected(MethodNotAllowed("GET, HEAD"));
    // The page itself, which has the form to log in.
    return Admitted{.target = *std::move(target), .match = {}, .caller = {}};
  }
  auto match = parts_->table.Find(request.method, target->segments);
  if (!match) {
    const std::string methods = parts_->table.AllowedMethods(target->segments);
    if (!methods.empty()) return std::unexpected(MethodNotAllowed(methods));
    return std::unexpected(ErrorResponse(NotFound("there is no such address; api/openapi.json lists them").error()));
  }
  if (match->route->is_probe) return Admitted{.target = *std::move(target), .match = *std::move(match), .caller = {}};
  auto caller = parts_->access->Admit(request, match->route->least, port);
  if (!caller) return std::unexpected(std::move(caller).error());
  return Admitted{.target = *std::move(target), .match = *std::move(match), .caller = *std::move(caller)};
}

ApiExpected<HttpResponse> Api::AskHandler(const HttpRequest& request, const Admitted& admitted, int port,
                                          const CancelToken& cancel) {
  const ApiRoute* route = admitted.match.route;
  if (route == nullptr) return parts_->page.Get(request, admitted.target.segments);
  QueryReader query(admitted.target);
  if (!route->has_query) VICTORIOUS_RETURN_IF_ERROR(query.CheckAllUsed());
  return route->handler({.request = request,
                         .parameters = admitted.match.parameters,
                         .query = query,
                         .caller = admitted.caller,
                         .port = port,
                         .cancel = cancel});
}

std::expected<UploadPlan, HttpResponse> Api::PlanUpload(const HttpRequest& request, int port) {
  const auto admitted = Admit(request, port);
  if (!admitted) return std::unexpected(admitted.error());
  const ApiRoute* route = admitted->match.route;
  if (route == nullptr || !route->is_upload) {
    return std::unexpected(ErrorResponse(NotFound("files are uploaded to /api/v1/uploads").error()));
  }
  auto plan = parts_->routes->jobs.PlanUpload(admitted->target, admitted->caller);
  if (!plan) return std::unexpected(ErrorResponse(plan.error()));
  return *std::move(plan);
}

}  // namespace victorious

#include "victorious/serve/api.h"

#include <algorithm>
#include <cmath>
#include <new>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/base/isolated_process.h"
#include "victorious/base/json.h"
#include "victorious/base/log.h"
#include "victorious/base/median.h"
#include "victorious/model/model_library.h"
#include "victorious/pipeline/camera_states.h"
#include "victorious/serve/api_json.h"
#include "victorious/serve/api_response.h"
#include "victorious/serve/byte_range.h"
#include "victorious/serve/request_guard.h"
#include "victorious/store/open_store.h"
#include "victorious/video/trusted_certificates.h"

namespace victorious {
namespace {

constexpr std::size_t kMaxCameraPaths = 200;   // bodies of at most 300 kB; a click on the map looks through 100 videos
constexpr std::size_t kMaxThresholdLists = 2;  // the present one, and one that others wait for
constexpr std::size_t kMaxCameras = 4;         // trajectories of some megabytes
constexpr std::size_t kMaxEvidence = 64;       // bodies of at most 150 kB
constexpr std::size_t kMaxModels = 8;          // mapped files of 9 to 32 MB: a turning model asks for hundreds of views

HttpResponse MethodNotAllowed(std::string_view allowed) {
  HttpResponse response = ErrorResponse(405, "method_not_allowed", fmt::format("only {} is answered here", allowed));
  response.headers.emplace_back("Allow", allowed);
  return response;
}

bool IsRead(const HttpRequest& request) {
  return request.method == HttpMethod::kGet || request.method == HttpMethod::kHead;
}

// @param name  that tells what kind of file it is
ApiExpected<HttpResponse> SendFile(const HttpRequest& request, const std::filesystem::path& path,
                                   const std::filesystem::path& name) {
  std::error_code error;
  const auto size = static_cast<std::int64_t>(std::filesystem::file_size(path, error));
  const std::string etag = FileEtag(path);
  if (error || etag.empty()) return NotFound(name.filename().string() + ": cannot be read");
  return FileResponse(request, path, size, ContentTypeOf(name), etag);
}

// As the page shows it: of a database all that its readers may see, of a file its name without its folder.
std::string NameOfIndex(const std::string& index) {
  return IsDatabaseUrl(index) ? StoreName(index) : std::filesystem::path(index).filename().string();
}

// The files that may be opened where the index names them.
FileRoots RootsOf(const ApiOptions& options) {
  std::vector<std::filesystem::path> roots = options.videos;
  std::vector<std::filesystem::path> secrets = options.secrets;
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

bool IsOfApi(std::span<const std::string> segments) { return !segments.empty() && segments.front() == "api"; }

}  // namespace

Api::Api(ApiOptions options, std::unique_ptr<IndexView> index, const CancelToken& cancel)
    : options_(std::move(options)),
      cancel_(cancel),
      index_(std::move(index)),
      roots_(RootsOf(options_), IsDatabaseUrl(options_.index) ? "" : options_.index),
      videos_(roots_),
      copies_(options_.copies, {.max_bytes = options_.max_copies_bytes}),
      page_(options_.web),
      camera_paths_(kMaxCameraPaths),
      threshold_lists_(kMaxThresholdLists),
      cameras_(kMaxCameras),
      evidence_(kMaxEvidence),
      models_(kMaxModels),
      uploads_(options_.uploads) {}

Expected<std::unique_ptr<Api>> Api::Open(ApiOptions options, const CancelToken& cancel) {
  VICTORIOUS_ASSIGN_OR_RETURN([[maybe_unused]] const std::filesystem::path decoder, DecoderProgram());
  if (!options.models.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN([[maybe_unused]] const auto names, ModelLibrary(options.models).Names());
  }
  VICTORIOUS_ASSIGN_OR_RETURN(std::unique_ptr<IndexView> index, IndexView::Open(options.index));
  std::optional<std::int64_t> telemetry_video;
  if (options.telemetry) {
    VICTORIOUS_ASSIGN_OR_RETURN(const auto lists, index->Lists());
    if (lists->videos.size() != 1) {
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("--telemetry: the index has {} videos, and the file belongs to one of them: name it "
                              "VIDEO.telemetry.csv beside its video, where it is found without the flag",
                              lists->videos.size()));
    }
    telemetry_video = lists->videos.front().id;
  }
  VICTORIOUS_ASSIGN_OR_RETURN(auto access, AccessControl::Open(options.index, index->can_review(), options.server));
  VICTORIOUS_ASSIGN_OR_RETURN(
      auto thresholds, OpenThresholdStore(options.index, index->can_review() ? StoreMode::kCreate : StoreMode::kRead));
  std::unique_ptr<Api> api(new Api(std::move(options), std::move(index), cancel));
  const SampleFiles sample = api->options_.sample.value_or(SampleFiles{});
  const JobFolders folders{.index = api->options_.index,
                           .models = api->options_.models,
                           .copies = api->options_.copies,
                           .categories = api->options_.categories,
                           .files = api->roots_.files(),
                           .uploads = api->options_.uploads,
                           .sample_scene = sample.scene,
                           .sample_object = sample.object,
                           .certificates = TrustedCertificates()};
  VICTORIOUS_ASSIGN_OR_RETURN(const auto lists, api->index_->Lists());
  if (const std::string outside = api->roots_.DescribeOutside(lists->videos); !outside.empty()) LogWarning(outside);
  api->telemetry_video_ = telemetry_video;
  api->access_ = std::move(access);
  api->thresholds_ = std::move(thresholds);
  VICTORIOUS_ASSIGN_OR_RETURN(api->live_, LiveService::Start(*api->index_, api->copies_, folders));
  return api;
}

HttpResponse Api::Handle(const HttpRequest& request, int port) {
  auto admitted = Admit(request, port);
  if (!admitted) return std::move(admitted).error();
  return Answer(request, *admitted, port, cancel_);
}

HttpResponse Api::Begin(const HttpRequest& request, int port) {
  auto admitted = Admit(request, port);
  if (!admitted) return std::move(admitted).error();
  const Route* route = admitted->match.route;
  if (route == nullptr || !route->is_slow) return Answer(request, *admitted, port, cancel_);
  const std::string client = request.client + " " + admitted->caller.name();
  HttpResponse response;
  response.slow = std::make_shared<SlowResponse>(SlowResponse{
      .client = client, .make = [this, request, admitted = *std::move(admitted), port](const CancelToken& left) {
        return Answer(request, admitted, port, left);
      }});
  return response;
}

HttpResponse Api::Answer(const HttpRequest& request, const Admitted& admitted, int port, const CancelToken& cancel) {
  try {
    auto answer = AskHandler(request, admitted, port, cancel);
    HttpResponse response = answer ? *std::move(answer) : ErrorResponse(answer.error());
    // Age says what it says in caches (RFC 9111): for so long, nobody looked whether the answer holds.
    const auto age = index_->ListsAge();
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
  if (auto refusal = RefuseForeign(request, is_of_api, options_.server, port)) {
    return std::unexpected(*std::move(refusal));
  }
  if (!target) return std::unexpected(ErrorResponse(target.error()));
  if (!IsOfApi(target->segments)) {
    if (!IsRead(request)) return std::unexpected(MethodNotAllowed("GET, HEAD"));
    // The page itself, which has the form to log in.
    return Admitted{.target = *std::move(target), .match = {}, .caller = {}};
  }
  auto match = FindRoute(request.method, target->segments);
  if (!match) {
    const std::string methods = AllowedMethods(target->segments);
    if (!methods.empty()) return std::unexpected(MethodNotAllowed(methods));
    return std::unexpected(ErrorResponse(NotFound("there is no such address; api/openapi.json lists them").error()));
  }
  auto caller = access_->Admit(request, match->route->least, port);
  if (!caller) return std::unexpected(std::move(caller).error());
  return Admitted{.target = *std::move(target), .match = *std::move(match), .caller = *std::move(caller)};
}

ApiExpected<HttpResponse> Api::AskHandler(const HttpRequest& request, const Admitted& admitted, int port,
                                          const CancelToken& cancel) {
  const Route* route = admitted.match.route;
  if (route == nullptr) return page_.Get(request, admitted.target.segments);
  QueryReader query(admitted.target);
  if (!route->has_query) VICTORIOUS_RETURN_IF_ERROR(query.CheckAllUsed());
  return (this->*route->handler)({.request = request,
                                  .parameters = admitted.match.parameters,
                                  .query = query,
                                  .caller = admitted.caller,
                                  .port = port,
                                  .cancel = cancel});
}

ApiExpected<Api::ListedVideo> Api::FindVideo(std::string_view id) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t number, ParseId(id, "video"));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto lists, index_->Lists());
  const VideoRecord* record = lists->Video(number);
  if (record == nullptr) return NotFound(fmt::format("video {} is not in the index", number));
  return ListedVideo{lists, record};
}

ApiExpected<HttpResponse> Api::Session(const Call& call) { return access_->Session(call.caller); }

ApiExpected<HttpResponse> Api::BaseMapFile(const Call& call) {
  if (options_.base_map.file.empty()) return NotFound("this server has no base map: `victorious serve --tiles FILE`");
  return SendFile(call.request, options_.base_map.file, options_.base_map.file);
}

ApiExpected<HttpResponse> Api::LogIn(const Call& call) { return access_->LogIn(call.request, call.port); }

ApiExpected<HttpResponse> Api::LogOut(const Call& call) { return access_->LogOut(call.caller, call.port); }

ApiExpected<HttpResponse> Api::Project(const Call& call) {
  VICTORIOUS_ASSIGN_OR_RETURN(const auto lists, index_->Lists());
  VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, index_->Borrow());
  VICTORIOUS_ASSIGN_OR_RETURN(const ObjectCounts counts, reader->objects->Count({}));
  const bool may_decide = call.caller.May(Role::kAnalyst);
  const bool has_jobs = live_->has_jobs() && may_decide;
  Json project = ProjectToJson(NameOfIndex(options_.index), *lists, counts, index_->can_review() && may_decide,
                               !options_.models.empty(), has_jobs, options_.categories, options_.base_map);
  project["has_targets"] = HasModels() || !options_.categories.empty();
  project["has_sample"] = has_jobs && HasSample(*lists);
  return JsonResponse(project);
}

ApiExpected<HttpResponse> Api::Audit(const Call& call) {
  constexpr std::int64_t kDefaultLimit = 100;
  VICTORIOUS_ASSIGN_OR_RETURN(const auto limit, call.query.Integer("limit", 1, 1000));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto before, call.query.Integer("before", 1, INT64_MAX));
  VICTORIOUS_RETURN_IF_ERROR(call.query.CheckAllUsed());
  VICTORIOUS_ASSIGN_OR_RETURN(const auto records, access_->Audit(limit.value_or(kDefaultLimit), before));
  return JsonResponse(AuditToJson(records));
}

ApiExpected<HttpResponse> Api::Videos(const Call& call) {
  VICTORIOUS_ASSIGN_OR_RETURN(const auto place, call.query.Place("shows"));
  VICTORIOUS_RETURN_IF_ERROR(call.query.CheckAllUsed());
  VICTORIOUS_ASSIGN_OR_RETURN(const auto lists, index_->Lists());
  std::vector<std::int64_t> showing;
  if (place) {
    VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, index_->Borrow());
    VICTORIOUS_ASSIGN_OR_RETURN(showing, reader->objects->VideosShowing(place->latitude_rad, place->longitude_rad));
  }
  Json rows = Json::array();
  for (const VideoRecord& video : lists->videos) {
    if (place && !std::ranges::binary_search(showing, video.id)) continue;
    const auto path = videos_.Find(video);
    rows.push_back(VideoToJson(video, *lists, path ? "" : path.error().message, copies_.Has(CopyName(video)),
                               /*with_searches=*/false));
  }
  return JsonResponse({{"videos", std::move(rows)}});
}

ApiExpected<HttpResponse> Api::Video(const Call& call) {
  VICTORIOUS_ASSIGN_OR_RETURN(const ListedVideo video, FindVideo(call.parameters[0]));
  const auto path = videos_.Find(*video.record);
  return JsonResponse(VideoToJson(*video.record, *video.lists, path ? "" : path.error().message,
                                  copies_.Has(CopyName(*video.record)), /*with_searches=*/true));
}

ApiExpected<HttpResponse> Api::VideoTimes(const Call& call) {
  VICTORIOUS_ASSIGN_OR_RETURN(const ListedVideo video, FindVideo(call.parameters[0]));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto times_s, videos_.Times(*video.record, call.cancel));
  Json rounded = Json::array();
  for (const double time_s : *times_s) rounded.push_back(TimeJson(time_s));
  return JsonResponse({{"times_s", std::move(rounded)}});
}

ApiExpected<HttpResponse> Api::VideoSightings(const Call& call) {
  VICTORIOUS_ASSIGN_OR_RETURN(const ListedVideo video, FindVideo(call.parameters[0]));
  return Sightings({.video = video.record->id}, call.query);
}

ApiExpected<HttpResponse> Api::VideoFile(const Call& call) {
  VICTORIOUS_ASSIGN_OR_RETURN(const ListedVideo video, FindVideo(call.parameters[0]));
  VICTORIOUS_ASSIGN_OR_RETURN(const OpenedFile file, roots_.Open(*video.record));
  // What was opened is sent, whatever has its name by then.
  VICTORIOUS_ASSIGN_OR_RETURN(HttpResponse response, SendFile(call.request, file.path, video.record->name));
  if (response.file) response.file->hold = file.descriptor;
  return response;
}

ApiExpected<HttpResponse> Api::VideoCopy(const Call& call) {
  VICTORIOUS_ASSIGN_OR_RETURN(const ListedVideo video, FindVideo(call.parameters[0]));
  const std::string name = CopyName(*video.record);
  if (copies_.Has(name)) return SendMade(call.request, name);
  return NotFound("there is no copy of the video for browsers: a job of the kind copy makes one");
}

ApiExpected<HttpResponse> Api::SendMade(const HttpRequest& request, const std::string& name) {
  const auto use = copies_.Take(name);
  if (!use) return NotFound("the file was removed to make room for others: ask for it again");
  VICTORIOUS_ASSIGN_OR_RETURN(HttpResponse response, SendFile(request, use->path, use->path));
  if (response.file) response.file->hold = use->hold;
  return response;
}

ApiExpected<HttpResponse> Api::VideoFrame(const Call& call) {
  VICTORIOUS_ASSIGN_OR_RETURN(const ListedVideo video, FindVideo(call.parameters[0]));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t frame, ParseId(call.parameters[1], "frame"));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto times_s, videos_.Times(*video.record, call.cancel));
  if (frame >= std::ssize(*times_s)) return NotFound(fmt::format("the video has {} frames", times_s->size()));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto bytes,
                              videos_.Frame(*video.record, (*times_s)[static_cast<std::size_t>(frame)], call.cancel));
  return TaggedResponse(call.request, "image/jpeg", *bytes, 60);
}

// From the telemetry; without it, from the camera positions stored with the sightings.
Expected<CameraPath> Api::ReadCameraPath(const VideoRecord& video, std::optional<double> ground_m,
                                         const CancelToken& cancel) {
  constexpr std::size_t kMaxPoints = 1000;
  constexpr int kMaxVisited = 100'000;
  std::string reason = "the video has no telemetry, and no file beside it";
  if (const auto path = videos_.Find(video)) {
    const auto cameras = LoadCameras(video, *path, {}, [&](const std::string& warning) { reason = warning; }, cancel);
    if (!cameras) return std::unexpected(cameras.error());
    if (cameras->HasStates()) {
      return MakeCameraPath(ThinStates(cameras->trajectory()->states(), kMaxPoints), CameraPathSource::kTelemetry,
                            video.width, video.height, ground_m);
    }
  }
  std::vector<CameraState> states;
  int visited = 0;
  VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, index_->Borrow());
  VICTORIOUS_RETURN_IF_ERROR(reader->sightings->VisitSightings({.video = video.id}, [&](SightingRecord&& sighting) {
    const bool is_new = states.empty() || states.back().time_s < sighting.time_s;
    if (sighting.observation && is_new) {
      states.push_back({.time_s = sighting.time_s, .place = sighting.observation->line.camera});
    }
    return ++visited < kMaxVisited;
  }));
  if (states.empty()) return CameraPath{.source = {}, .reason = reason, .ground_m = ground_m, .points = {}};
  CameraPath path =
      MakeCameraPath(ThinStates(states, kMaxPoints), CameraPathSource::kSightings, video.width, video.height, {});
  path.reason = reason + ", so the path is known only where objects were seen: `victorious serve --telemetry FILE` " +
                "names a file";
  return path;
}

ApiExpected<HttpResponse> Api::VideoCamera(const Call& call) {
  VICTORIOUS_ASSIGN_OR_RETURN(const ListedVideo listed, FindVideo(call.parameters[0]));
  const VideoRecord& video = *listed.record;
  std::optional<double> ground_m;
  {
    VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, index_->Borrow());
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<double> heights_m, reader->objects->PlaceHeights(video.id));
    if (!heights_m.empty()) ground_m = Median(heights_m);
  }
  // The ground's height, and with it the footprints, follows the objects.
  const std::string key =
      fmt::format("{} {} {} {}", video.content_id, ground_m.value_or(NAN), video.id, video.telemetry);
  VICTORIOUS_ASSIGN_OR_RETURN(
      const auto body, GetUnlessCancelled(camera_paths_, key, call.cancel, [&]() -> Expected<std::string> {
        VICTORIOUS_ASSIGN_OR_RETURN(const CameraPath path, ReadCameraPath(video, ground_m, call.cancel));
        return DumpJson(CameraPathToJson(path)) + "\n";
      }));
  return JsonTextResponse(*body);
}

}  // namespace victorious

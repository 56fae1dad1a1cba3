#include "victorious/serve/api.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/base/json.h"
#include "victorious/base/median.h"
#include "victorious/model/model_library.h"
#include "victorious/pipeline/camera_states.h"
#include "victorious/serve/api_json.h"
#include "victorious/serve/byte_range.h"
#include "victorious/serve/request_guard.h"

namespace victorious {
namespace {

constexpr std::size_t kCameraCacheBytes = std::size_t{32} << 20;

HttpResponse JsonResponse(const Json& json) {
  return {.content_type = "application/json",
          .headers = {{"Cache-Control", "no-store"}},
          .body = Dump(json) + "\n",
          .file = {}};
}

std::unexpected<ApiError> NotFound(std::string message) {
  return std::unexpected(ApiError(Error{ErrorCode::kNotFound, std::move(message)}));
}

// An image under a tag of its content, so that a browser asks again without receiving it again.
HttpResponse ImageResponse(const HttpRequest& request, std::string bytes) {
  const std::string etag = fmt::format("\"{:016x}\"", Checksum(std::as_bytes(std::span(bytes))));
  HttpResponse response{.content_type = "image/jpeg",
                        .headers = {{"ETag", etag}, {"Cache-Control", "private, max-age=60"}},
                        .body = {},
                        .file = {}};
  if (MatchesEtag(request.if_none_match, etag)) {
    response.status = 304;
    response.content_type.clear();
  } else {
    response.body = std::move(bytes);
  }
  return response;
}

// The position of an object in the ranked list; kept by a cursor while objects come and go.
struct RankKey {
  double score = 0;
  std::int64_t frames = 0;
  std::int64_t id = 0;
};

RankKey KeyOf(const ListedObject& listed) { return {listed.object.score, listed.object.frames, listed.object.id}; }

// The order of IndexStore::Objects.
bool IsBefore(const RankKey& a, const RankKey& b) {
  if (a.score != b.score) return a.score > b.score;
  if (a.frames != b.frames) return a.frames > b.frames;
  return a.id < b.id;
}

std::string CursorOf(const ListedObject& listed) {
  const RankKey key = KeyOf(listed);
  return fmt::format("{:.17g}_{}_{}", key.score, key.frames, key.id);
}

std::optional<RankKey> ParseCursor(std::string_view text) {
  RankKey key;
  const char* at = text.data();
  const char* const end = text.data() + text.size();
  const auto parse = [&](auto& value, bool is_last) {
    const auto [next, error] = std::from_chars(at, end, value);
    const bool is_valid = error == std::errc() && (is_last ? next == end : next != end && *next == '_');
    at = is_valid && !is_last ? next + 1 : next;
    return is_valid;
  };
  const bool is_valid = parse(key.score, false) && parse(key.frames, false) && parse(key.id, true);
  return is_valid ? std::optional(key) : std::nullopt;
}

// The filters of the list of objects.
struct ObjectFilter {
  std::optional<std::string> model;
  std::optional<std::int64_t> video;
  std::optional<double> min_score;
  std::optional<double> from_s;
  std::optional<double> to_s;
  std::optional<GeoCircle> near;
  std::optional<std::string> review;

  [[nodiscard]] bool Matches(const ListedObject& listed, const IndexSnapshot& snapshot) const;
};

constexpr std::array<std::string_view, 3> kReviewFilters = {"accepted", "rejected", "none"};

bool ObjectFilter::Matches(const ListedObject& listed, const IndexSnapshot& snapshot) const {
  if (model && listed.model != *model) return false;
  if (min_score && listed.object.score < *min_score) return false;
  if (video || from_s || to_s) {
    const auto moments = snapshot.lists->moments.find(listed.object.id);
    if (moments == snapshot.lists->moments.end()) return false;
    const bool is_seen = std::ranges::any_of(moments->second, [&](const TrackletRecord& one) {
      return (!video || one.video == *video) && (!from_s || one.last_time_s >= *from_s) &&
             (!to_s || one.first_time_s <= *to_s);
    });
    if (!is_seen) return false;
  }
  if (near) {
    if (!listed.object.place) return false;
    GeodeticPoint point = listed.object.place->point;
    point.altitude_m = near->centre.altitude_m;
    if (TangentPlane(near->centre).EnuFromGeodetic(point).norm() > near->radius_m) return false;
  }
  if (review) {
    const auto found = snapshot.reviews->find(listed.object.id);
    const auto verdict = found == snapshot.reviews->end() ? std::nullopt : found->second.verdict;
    if ((verdict ? ToText(*verdict) : "none") != *review) return false;
  }
  return true;
}

ApiExpected<ObjectFilter> ReadObjectFilter(QueryReader& query) {
  ObjectFilter filter;
  filter.model = query.Text("model");
  filter.review = query.Text("review");
  if (filter.review && std::ranges::find(kReviewFilters, *filter.review) == kReviewFilters.end()) {
    return FailField("review", fmt::format("review \"{}\": must be accepted, rejected or none", *filter.review));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(filter.video, query.Integer("video", 0, INT64_MAX));
  VICTORIOUS_ASSIGN_OR_RETURN(filter.min_score, query.Number("min_score", 0, 1));
  VICTORIOUS_ASSIGN_OR_RETURN(filter.from_s, query.Number("from", 0, 1e9));
  VICTORIOUS_ASSIGN_OR_RETURN(filter.to_s, query.Number("to", 0, 1e9));
  VICTORIOUS_ASSIGN_OR_RETURN(filter.near, query.Circle("near"));
  return filter;
}

// The body of a review. Error: the field that is wrong.
ApiExpected<Review> ParseReview(std::string_view body) {
  constexpr std::size_t kMaxNoteBytes = 4000;
  const auto json = ParseJson(body);
  if (!json) return std::unexpected(ApiError(json.error()));
  if (!json->is_object()) return FailField("", "the body must be {\"verdict\": …, \"note\": …}");
  Review review;
  for (const auto& [key, value] : json->items()) {
    if (key == "verdict") {
      if (value.is_null()) continue;
      if (value.is_string()) review.verdict = FromText(kVerdictTexts, value.get<std::string>());
      if (!review.verdict) return FailField("verdict", "verdict: must be \"accepted\", \"rejected\" or null");
    } else if (key == "note") {
      if (!value.is_string()) return FailField("note", "note: must be a text");
      review.note = value.get<std::string>();
      if (review.note.size() > kMaxNoteBytes) {
        return FailField("note",
                         fmt::format("note: has {} bytes, at most {} are kept", review.note.size(), kMaxNoteBytes));
      }
    } else {
      return FailField(key, "only verdict and note can be set");
    }
  }
  return review;
}

ApiExpected<HttpResponse> MethodNotAllowed(std::string_view allowed) {
  HttpResponse response = ErrorResponse(405, "method_not_allowed", fmt::format("only {} is answered here", allowed));
  response.headers.emplace_back("Allow", allowed);
  return response;
}

bool IsRead(const HttpRequest& request) {
  return request.method == HttpMethod::kGet || request.method == HttpMethod::kHead;
}

}  // namespace

Api::Api(ApiOptions options, std::unique_ptr<IndexView> index, const CancelToken& cancel)
    : options_(std::move(options)),
      index_(std::move(index)),
      videos_(options_.index, cancel),
      page_(options_.web),
      camera_paths_(kCameraCacheBytes) {}

Expected<std::unique_ptr<Api>> Api::Open(ApiOptions options, const CancelToken& cancel) {
  if (!options.models.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN([[maybe_unused]] const auto names, ModelLibrary(options.models).Names());
  }
  VICTORIOUS_ASSIGN_OR_RETURN(std::unique_ptr<IndexView> index, IndexView::Open(options.index));
  if (options.telemetry) {
    VICTORIOUS_ASSIGN_OR_RETURN(const IndexSnapshot snapshot, index->Snapshot());
    if (snapshot.lists->videos.size() != 1) {
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("--telemetry: the index has {} videos: it is for an index of one video",
                              snapshot.lists->videos.size()));
    }
  }
  return std::unique_ptr<Api>(new Api(std::move(options), std::move(index), cancel));
}

HttpResponse Api::Handle(const HttpRequest& request, int port) {
  if (auto refusal = RefuseForeign(request, port)) return *std::move(refusal);
  const auto target = ParseRequestTarget(request.target);
  if (!target) return ErrorResponse(target.error());
  auto response = Route(request, *target);
  return response ? *std::move(response) : ErrorResponse(response.error());
}

ApiExpected<HttpResponse> Api::Route(const HttpRequest& request, const RequestTarget& target) {
  const Segments segments = target.segments;
  if (segments.empty() || segments.front() != "api") {
    if (!IsRead(request)) return MethodNotAllowed("GET, HEAD");
    return page_.Get(request, target.segments);
  }
  QueryReader query(target);
  const bool is_review = segments.size() == 5 && segments[2] == "objects" && segments[4] == "review";
  if (is_review ? request.method != HttpMethod::kPut : !IsRead(request)) {
    return MethodNotAllowed(is_review ? "PUT" : "GET, HEAD");
  }
  if (segments.size() >= 3 && segments[1] == "v1") {
    const std::string& resource = segments[2];
    if (resource == "videos" && segments.size() > 3) return RouteVideo(request, segments.subspan(3), query);
    if (resource == "objects" && segments.size() > 3) return RouteObject(request, segments.subspan(3), query);
    if (resource == "objects") return Objects(query);
    if (resource == "models" && segments.size() == 6 && segments[4] == "views") {
      VICTORIOUS_RETURN_IF_ERROR(query.CheckAllUsed());
      return ViewImage(request, segments.subspan(3));
    }
    if (segments.size() == 3 && (resource == "project" || resource == "videos")) {
      VICTORIOUS_RETURN_IF_ERROR(query.CheckAllUsed());
      return resource == "project" ? Project() : Videos();
    }
  }
  return NotFound("there is no such address; api/openapi.json lists them");
}

ApiExpected<HttpResponse> Api::RouteVideo(const HttpRequest& request, Segments segments, QueryReader& query) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t id, ParseId(segments[0], "video"));
  VICTORIOUS_ASSIGN_OR_RETURN(const IndexSnapshot snapshot, index_->Snapshot());
  const VideoRecord* video = snapshot.lists->Video(id);
  if (video == nullptr) return NotFound(fmt::format("video {} is not in the index", id));
  if (segments.size() == 2 && segments[1] == "sightings") return Sightings({.video = id}, query);
  VICTORIOUS_RETURN_IF_ERROR(query.CheckAllUsed());
  if (segments.size() == 1) {
    const auto path = videos_.Find(*video);
    return JsonResponse(VideoToJson(*video, *snapshot.lists, path ? "" : path.error().message));
  }
  if (segments.size() == 2 && segments[1] == "file") return VideoFile(request, *video);
  if (segments.size() == 2 && segments[1] == "camera") return Camera(*snapshot.lists, *video);
  if (segments.size() == 2 && segments[1] == "times") {
    VICTORIOUS_ASSIGN_OR_RETURN(const auto times_s, videos_.Times(*video));
    Json rounded = Json::array();
    for (const double time_s : *times_s) rounded.push_back(TimeJson(time_s));
    return JsonResponse({{"times_s", std::move(rounded)}});
  }
  if (segments.size() == 3 && segments[1] == "frames") return VideoFrame(request, *video, segments[2]);
  return NotFound("there is no such address of a video; api/openapi.json lists them");
}

ApiExpected<HttpResponse> Api::RouteObject(const HttpRequest& request, Segments segments, QueryReader& query) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t id, ParseId(segments[0], "object"));
  VICTORIOUS_ASSIGN_OR_RETURN(const IndexSnapshot snapshot, index_->Snapshot());
  const ListedObject* object = snapshot.lists->Object(id);
  if (object == nullptr) {
    return NotFound(fmt::format("object {} is not in the index (a search may have joined or removed it)", id));
  }
  if (segments.size() == 2 && segments[1] == "sightings") return Sightings({.object = id}, query);
  if (segments.size() == 2 && segments[1] == "thumbnail") return Thumbnail(request, snapshot, *object, query);
  VICTORIOUS_RETURN_IF_ERROR(query.CheckAllUsed());
  if (segments.size() == 1) return Object(snapshot, *object);
  if (segments.size() == 2 && segments[1] == "review") return PutReview(request, *object);
  return NotFound("there is no such address of an object; api/openapi.json lists them");
}

ApiExpected<HttpResponse> Api::Project() {
  VICTORIOUS_ASSIGN_OR_RETURN(const IndexSnapshot snapshot, index_->Snapshot());
  return JsonResponse(ProjectToJson(options_.index, snapshot, index_->can_review(), !options_.models.empty()));
}

ApiExpected<HttpResponse> Api::Videos() {
  VICTORIOUS_ASSIGN_OR_RETURN(const IndexSnapshot snapshot, index_->Snapshot());
  Json rows = Json::array();
  for (const VideoRecord& video : snapshot.lists->videos) {
    const auto path = videos_.Find(video);
    rows.push_back(VideoToJson(video, *snapshot.lists, path ? "" : path.error().message));
  }
  return JsonResponse({{"videos", std::move(rows)}});
}

ApiExpected<HttpResponse> Api::Objects(QueryReader& query) {
  constexpr std::int64_t kDefaultLimit = 200;
  VICTORIOUS_ASSIGN_OR_RETURN(const ObjectFilter filter, ReadObjectFilter(query));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto limit, query.Integer("limit", 1, 1000));
  const auto cursor_text = query.Text("cursor");
  VICTORIOUS_RETURN_IF_ERROR(query.CheckAllUsed());
  const std::optional<RankKey> cursor = cursor_text ? ParseCursor(*cursor_text) : std::nullopt;
  if (cursor_text && !cursor) return FailField("cursor", "cursor: must be the next_cursor of another answer");
  VICTORIOUS_ASSIGN_OR_RETURN(const IndexSnapshot snapshot, index_->Snapshot());
  const std::vector<ListedObject>& objects = snapshot.lists->objects;
  auto at = cursor ? std::ranges::upper_bound(objects, *cursor, &IsBefore, &KeyOf) : objects.begin();
  Json rows = Json::array();
  const ListedObject* last = nullptr;
  Json next;
  for (; at != objects.end(); ++at) {
    if (!filter.Matches(*at, snapshot)) continue;
    if (std::ssize(rows) == limit.value_or(kDefaultLimit)) {
      next = CursorOf(*last);
      break;
    }
    rows.push_back(ObjectToJson(*at, snapshot));
    last = &*at;
  }
  return JsonResponse({{"objects", std::move(rows)}, {"next_cursor", std::move(next)}});
}

Expected<std::optional<SightingRecord>> Api::BestSighting(std::int64_t object) {
  constexpr int kMaxVisited = 20'000;
  std::optional<SightingRecord> best;
  int visited = 0;
  const auto rank = [](const SightingRecord& one) { return std::pair(one.matches, one.score); };
  VICTORIOUS_RETURN_IF_ERROR(
      index_->VisitSightings({.include_rejected = true, .object = object}, [&](SightingRecord&& sighting) {
        if (!best || rank(sighting) > rank(*best)) best = std::move(sighting);
        return ++visited < kMaxVisited;
      }));
  return best;
}

ApiExpected<HttpResponse> Api::Object(const IndexSnapshot& snapshot, const ListedObject& object) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<SightingRecord> best, BestSighting(object.object.id));
  Json json = ObjectToJson(object, snapshot);
  json["best"] = best ? SightingToJson(*best) : Json();
  return JsonResponse(json);
}

ApiExpected<HttpResponse> Api::Sightings(SightingFilter filter, QueryReader& query) {
  constexpr std::int64_t kDefaultLimit = 2000;
  VICTORIOUS_ASSIGN_OR_RETURN(filter.from_s, query.Number("from", 0, 1e9));
  VICTORIOUS_ASSIGN_OR_RETURN(filter.to_s, query.Number("to", 0, 1e9));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto limit, query.Integer("limit", 1, 10'000));
  VICTORIOUS_RETURN_IF_ERROR(query.CheckAllUsed());
  Json rows = Json::array();
  bool is_truncated = false;
  VICTORIOUS_RETURN_IF_ERROR(index_->VisitSightings(filter, [&](SightingRecord&& sighting) {
    is_truncated = std::ssize(rows) == limit.value_or(kDefaultLimit);
    if (!is_truncated) rows.push_back(SightingToJson(sighting));
    return !is_truncated;
  }));
  return JsonResponse({{"sightings", std::move(rows)}, {"truncated", is_truncated}});
}

ApiExpected<HttpResponse> Api::Thumbnail(const HttpRequest& request, const IndexSnapshot& snapshot,
                                         const ListedObject& object, QueryReader& query) {
  constexpr std::int64_t kDefaultWidth = 240;
  VICTORIOUS_ASSIGN_OR_RETURN(const auto width, query.Integer("width", 32, 640));
  VICTORIOUS_RETURN_IF_ERROR(query.CheckAllUsed());
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<SightingRecord> best, BestSighting(object.object.id));
  const VideoRecord* video = best ? snapshot.lists->Video(best->video) : nullptr;
  if (video == nullptr) return NotFound(fmt::format("object {} has no sighting", object.object.id));
  VICTORIOUS_ASSIGN_OR_RETURN(
      const auto bytes, videos_.Crop(*video, best->time_s, best->box, static_cast<int>(width.value_or(kDefaultWidth))));
  return ImageResponse(request, *bytes);
}

ApiExpected<HttpResponse> Api::PutReview(const HttpRequest& request, const ListedObject& object) {
  VICTORIOUS_ASSIGN_OR_RETURN(Review review, ParseReview(request.body));
  VICTORIOUS_ASSIGN_OR_RETURN(review, index_->PutReview(object.object.id, std::move(review)));
  return JsonResponse({{"object_id", object.object.id}, {"review", ReviewToJson(&review)}});
}

ApiExpected<HttpResponse> Api::VideoFile(const HttpRequest& request, const VideoRecord& video) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::filesystem::path path, videos_.Find(video));
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    return std::unexpected(
        ApiError(Error{ErrorCode::kUnsupported, path.string() + ": a folder of images: read its frames one by one"}));
  }
  const auto size = static_cast<std::int64_t>(std::filesystem::file_size(path, error));
  const std::string etag = FileEtag(path);
  if (error || etag.empty()) return NotFound(path.string() + ": cannot be read");
  return FileResponse(request, path, size, ContentTypeOf(path), etag);
}

ApiExpected<HttpResponse> Api::VideoFrame(const HttpRequest& request, const VideoRecord& video,
                                          std::string_view number) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t frame, ParseId(number, "frame"));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto times_s, videos_.Times(video));
  if (frame >= std::ssize(*times_s)) return NotFound(fmt::format("the video has {} frames", times_s->size()));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto bytes, videos_.Frame(video, (*times_s)[static_cast<std::size_t>(frame)]));
  return ImageResponse(request, *bytes);
}

// The camera positions stored with the sightings: one a frame.
Expected<CameraPath> Api::ReadCameraPath(const IndexLists& lists, const VideoRecord& video) {
  constexpr std::size_t kMaxPoints = 1000;
  constexpr int kMaxVisited = 100'000;
  std::vector<double> heights_m;
  for (const ListedObject& one : lists.objects) {
    const bool is_here = std::ranges::find(one.object.videos, video.id) != one.object.videos.end();
    if (is_here && one.object.place) heights_m.push_back(one.object.place->point.altitude_m);
  }
  const auto ground_m = heights_m.empty() ? std::nullopt : std::optional(Median(heights_m));
  std::string why;
  if (const auto path = videos_.Find(video)) {
    const std::optional<std::string>& file = options_.telemetry;
    VideoInfo info;
    info.duration_s = video.duration_s;
    const auto cameras = CameraStates::Load(path->string(), info, file, {}, "the map has no camera path",
                                            [&](const std::string& warning) { why = warning; });
    if (!cameras) return std::unexpected(cameras.error());
    if (cameras->HasStates()) {
      return MakeCameraPath(ThinStates(cameras->trajectory()->states(), kMaxPoints), "telemetry", video.width,
                            video.height, ground_m);
    }
  }
  std::vector<CameraState> states;
  int visited = 0;
  VICTORIOUS_RETURN_IF_ERROR(index_->VisitSightings({.video = video.id}, [&](SightingRecord&& sighting) {
    const bool is_new = states.empty() || states.back().time_s < sighting.time_s;
    if (sighting.observation && is_new) {
      states.push_back({.time_s = sighting.time_s, .place = sighting.observation->line.camera});
    }
    return ++visited < kMaxVisited;
  }));
  if (states.empty()) {
    if (why.empty()) why = "the video has no telemetry, and no file beside it";
    return CameraPath{.source = {}, .reason = why, .ground_m = ground_m, .points = {}};
  }
  CameraPath path = MakeCameraPath(ThinStates(states, kMaxPoints), "sightings", video.width, video.height, {});
  path.reason =
      "the telemetry file was not found, so the path is known only where objects were seen: "
      "`victorious serve --telemetry FILE` names it";
  return path;
}

ApiExpected<HttpResponse> Api::Camera(const IndexLists& lists, const VideoRecord& video) {
  // The ground's height, and with it the footprints, follows the objects.
  const std::string key = fmt::format("{} {} {}", video.content_id, lists.objects.size(), video.id);
  const std::scoped_lock lock(camera_mutex_);
  auto body = camera_paths_.Find(key);
  if (!body) {
    VICTORIOUS_ASSIGN_OR_RETURN(const CameraPath path, ReadCameraPath(lists, video));
    body = std::make_shared<const std::string>(Dump(CameraPathToJson(path)) + "\n");
    camera_paths_.Put(key, body);
  }
  return HttpResponse{
      .content_type = "application/json", .headers = {{"Cache-Control", "no-store"}}, .body = *body, .file = {}};
}

ApiExpected<HttpResponse> Api::ViewImage(const HttpRequest& request, Segments segments) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t id, ParseId(segments[0], "model"));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t view, ParseId(segments[2], "view"));
  VICTORIOUS_ASSIGN_OR_RETURN(const IndexSnapshot snapshot, index_->Snapshot());
  const ModelRecord* record = snapshot.lists->Model(id);
  if (record == nullptr) return NotFound(fmt::format("model {} is not in the index", id));
  if (options_.models.empty() || record->IsCategory()) {
    return NotFound(
        fmt::format("the views of {} are not known: `victorious serve --models DIR` names the models", record->name));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const ObjectModel model, ModelLibrary(options_.models).Load(record->name));
  if (model.id != record->content_id) {
    return std::unexpected(
        ApiError(Error{ErrorCode::kConflict, fmt::format("{}: the model in {} is not the one that was searched for",
                                                         record->name, options_.models.string())}));
  }
  if (view >= std::ssize(model.views) || model.views[static_cast<std::size_t>(view)].thumbnail.empty()) {
    return NotFound(fmt::format("{} has {} views; view {} has no image", record->name, model.views.size(), view));
  }
  const auto bytes = model.views[static_cast<std::size_t>(view)].thumbnail;
  return ImageResponse(request, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace victorious

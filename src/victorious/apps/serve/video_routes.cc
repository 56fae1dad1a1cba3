#include "victorious/apps/serve/video_routes.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/apps/serve/api_json.h"
#include "victorious/apps/serve/api_response.h"
#include "victorious/apps/serve/file_response.h"
#include "victorious/apps/serve/index_lookup.h"
#include "victorious/apps/serve/request_target.h"
#include "victorious/base/json.h"
#include "victorious/base/median.h"
#include "victorious/place/cameras/camera_states.h"

namespace victorious {
namespace {

constexpr std::size_t kMaxCameraPaths = 200;  // bodies of at most 300 kB; a click on the map looks through 100 videos

}  // namespace

VideoRoutes::VideoRoutes(IndexView& index, VideoFiles& videos, CopyFolder& copies)
    : index_(index), videos_(videos), copies_(copies), camera_paths_(kMaxCameraPaths) {}

ApiExpected<HttpResponse> VideoRoutes::List(const ApiCall& call) {
  VICTORIOUS_ASSIGN_OR_RETURN(const auto place, call.query.Place("shows"));
  VICTORIOUS_RETURN_IF_ERROR(call.query.CheckAllUsed());
  VICTORIOUS_ASSIGN_OR_RETURN(const auto lists, index_.Lists());
  std::vector<std::int64_t> showing;
  if (place) {
    VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, index_.Borrow());
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

ApiExpected<HttpResponse> VideoRoutes::Get(const ApiCall& call) {
  VICTORIOUS_ASSIGN_OR_RETURN(const ListedVideo video, FindVideo(index_, call.parameters[0]));
  const auto path = videos_.Find(*video.record);
  return JsonResponse(VideoToJson(*video.record, *video.lists, path ? "" : path.error().message,
                                  copies_.Has(CopyName(*video.record)), /*with_searches=*/true));
}

ApiExpected<HttpResponse> VideoRoutes::Times(const ApiCall& call) {
  VICTORIOUS_ASSIGN_OR_RETURN(const ListedVideo video, FindVideo(index_, call.parameters[0]));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto times_s, videos_.Times(*video.record, call.cancel));
  Json rounded = Json::array();
  for (const double time_s : *times_s) rounded.push_back(TimeJson(time_s));
  return JsonResponse({{"times_s", std::move(rounded)}});
}

ApiExpected<HttpResponse> VideoRoutes::Sightings(const ApiCall& call) {
  VICTORIOUS_ASSIGN_OR_RETURN(const ListedVideo video, FindVideo(index_, call.parameters[0]));
  return SightingsResponse(index_, {.video = video.record->id}, call.query);
}

ApiExpected<HttpResponse> VideoRoutes::File(const ApiCall& call) {
  VICTORIOUS_ASSIGN_OR_RETURN(const ListedVideo video, FindVideo(index_, call.parameters[0]));
  VICTORIOUS_ASSIGN_OR_RETURN(const OpenedFile file, videos_.roots().Open(*video.record));
  // What was opened is sent, whatever has its name by then.
  VICTORIOUS_ASSIGN_OR_RETURN(HttpResponse response, SendFile(call.request, file.path, video.record->name));
  if (response.file) response.file->hold = file.descriptor;
  return response;
}

ApiExpected<HttpResponse> VideoRoutes::Copy(const ApiCall& call) {
  VICTORIOUS_ASSIGN_OR_RETURN(const ListedVideo video, FindVideo(index_, call.parameters[0]));
  const std::string name = CopyName(*video.record);
  if (copies_.Has(name)) return SendMade(call.request, copies_, name);
  return NotFound("there is no copy of the video for browsers: a job of the kind copy makes one");
}

ApiExpected<HttpResponse> VideoRoutes::Frame(const ApiCall& call) {
  VICTORIOUS_ASSIGN_OR_RETURN(const ListedVideo video, FindVideo(index_, call.parameters[0]));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t frame, ParseId(call.parameters[1], "frame"));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto times_s, videos_.Times(*video.record, call.cancel));
  if (frame >= std::ssize(*times_s)) return NotFound(fmt::format("the video has {} frames", times_s->size()));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto bytes,
                              videos_.Frame(*video.record, (*times_s)[static_cast<std::size_t>(frame)], call.cancel));
  return TaggedResponse(call.request, "image/jpeg", *bytes, 60);
}

// From the telemetry; without it, from the camera positions stored with the sightings.
Expected<CameraPath> VideoRoutes::ReadCameraPath(const VideoRecord& video, std::optional<double> ground_m,
                                                 const CancelToken& cancel) {
  constexpr std::size_t kMaxPoints = 1000;
  constexpr int kMaxVisited = 100'000;
  std::string reason = "the video has no telemetry, and no file beside it";
  if (const auto path = videos_.Find(video)) {
    const auto cameras =
        videos_.Cameras(video, *path, {}, [&](const std::string& warning) { reason = warning; }, cancel);
    if (!cameras) return std::unexpected(cameras.error());
    if (cameras->HasStates()) {
      return MakeCameraPath(ThinStates(cameras->trajectory()->states(), kMaxPoints), CameraPathSource::kTelemetry,
                            video.width, video.height, ground_m);
    }
  }
  std::vector<CameraState> states;
  int visited = 0;
  VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, index_.Borrow());
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

ApiExpected<HttpResponse> VideoRoutes::Camera(const ApiCall& call) {
  VICTORIOUS_ASSIGN_OR_RETURN(const ListedVideo listed, FindVideo(index_, call.parameters[0]));
  const VideoRecord& video = *listed.record;
  std::optional<double> ground_m;
  {
    VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, index_.Borrow());
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

// The routes of `victorious serve`: from a request to its response. api/openapi.json describes them. No network here:
// http_server.h calls Handle from several threads.
#pragma once

#include <cstdint>
#include <expected>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "victorious/base/cancel.h"
#include "victorious/serve/access_control.h"
#include "victorious/serve/api_error.h"
#include "victorious/serve/camera_path.h"
#include "victorious/serve/copy_folder.h"
#include "victorious/serve/http_message.h"
#include "victorious/serve/index_view.h"
#include "victorious/serve/live_service.h"
#include "victorious/serve/request_target.h"
#include "victorious/serve/static_files.h"
#include "victorious/serve/upload_folder.h"
#include "victorious/serve/video_files.h"
#include "victorious/store/export_json.h"

namespace victorious {

struct ApiOptions {
  std::filesystem::path index;
  std::filesystem::path models;          ///< model library, for the images of views; empty: none
  std::optional<std::string> telemetry;  ///< telemetry file of the index's only video; std::nullopt: found by itself
  std::filesystem::path web;             ///< the built page
  std::filesystem::path uploads;         ///< where uploaded files go; created when it is needed
  std::filesystem::path copies;          ///< where the videos go that are made for users; created when it is needed
  std::uint64_t max_copies_bytes = CopyFolder::Limits().max_bytes;
  std::uint64_t max_upload_bytes = std::uint64_t{50} << 30;
  ServerIdentity server;
};

/// Thread-safe.
class Api {
 public:
  /// @param cancel  ends long reading of videos; must outlive the Api
  /// Errors: those of IndexView::Open and AccessControl::Open; kInvalidArgument for telemetry with several videos; kNotFound for a models
  /// folder that is not there.
  [[nodiscard]] static Expected<std::unique_ptr<Api>> Open(ApiOptions options, const CancelToken& cancel);

  /// @param port  of the server: the Host header must name it
  [[nodiscard]] HttpResponse Handle(const HttpRequest& request, int port);

  /// Where the body of an upload goes, or the response that refuses it.
  [[nodiscard]] std::expected<UploadPlan, HttpResponse> PlanUpload(const HttpRequest& request, int port);

 private:
  Api(ApiOptions options, std::unique_ptr<IndexView> index, const CancelToken& cancel);

  using Segments = std::span<const std::string>;

  /// A request that may be answered.
  struct Admitted {
    RequestTarget target;
    Caller caller;
  };
  /// Refuses what comes from elsewhere, what has no rule, and whom the rule does not admit.
  [[nodiscard]] std::expected<Admitted, HttpResponse> Admit(const HttpRequest& request, int port);
  ApiExpected<HttpResponse> Route(const HttpRequest& request, const Admitted& admitted, int port);
  ApiExpected<HttpResponse> RouteVideo(const HttpRequest& request, Segments segments, QueryReader& query);
  ApiExpected<HttpResponse> RouteObject(const HttpRequest& request, Segments segments, QueryReader& query,
                                        const Caller& caller);
  ApiExpected<HttpResponse> Project(const Caller& caller);
  ApiExpected<HttpResponse> Audit(QueryReader& query);
  ApiExpected<HttpResponse> Videos();
  // In api_jobs.cc.
  ApiExpected<HttpResponse> Upload(const HttpRequest& request, const Caller& caller);
  ApiExpected<HttpResponse> Jobs();
  /// The input of a job (job_runner.h), from the body of the request for it.
  ApiExpected<Json> JobInput(JobKind kind, const nlohmann::json& body);
  ApiExpected<Json> IndexInput(const nlohmann::json& body);
  ApiExpected<Json> ModelInput(const nlohmann::json& body);
  ApiExpected<Json> CopyInput(const nlohmann::json& body);
  ApiExpected<Json> ClipInput(const nlohmann::json& body);
  /// Writes a frame of a video as an image among the uploads.
  ApiExpected<std::filesystem::path> SaveFrame(const nlohmann::json& body);
  ApiExpected<HttpResponse> SubmitJob(const HttpRequest& request, const Caller& caller);
  ApiExpected<HttpResponse> CancelJob(std::string_view number, const Caller& caller);
  ApiExpected<HttpResponse> JobFile(const HttpRequest& request, std::string_view number, std::string_view name);
  ApiExpected<HttpResponse> SendMade(const HttpRequest& request, const std::string& name);
  ApiExpected<HttpResponse> Events();
  // In api_objects.cc.
  ApiExpected<HttpResponse> Objects(QueryReader& query);
  ApiExpected<HttpResponse> Counts(QueryReader& query);
  ApiExpected<HttpResponse> Tile(const HttpRequest& request, Segments address, QueryReader& query);
  ApiExpected<HttpResponse> Object(const IndexLists& lists, const TriageObject& object);
  ApiExpected<HttpResponse> Sightings(SightingFilter filter, QueryReader& query);
  ApiExpected<HttpResponse> Thumbnail(const HttpRequest& request, const IndexLists& lists, std::int64_t object,
                                      QueryReader& query);
  ApiExpected<HttpResponse> PutReview(const HttpRequest& request, std::int64_t object, const Caller& caller);
  ApiExpected<HttpResponse> VideoFile(const HttpRequest& request, const VideoRecord& video);
  ApiExpected<HttpResponse> VideoCopy(const HttpRequest& request, const VideoRecord& video);
  ApiExpected<HttpResponse> VideoFrame(const HttpRequest& request, const VideoRecord& video, std::string_view number);
  ApiExpected<HttpResponse> Camera(const VideoRecord& video);
  ApiExpected<HttpResponse> ViewImage(const HttpRequest& request, Segments segments);
  [[nodiscard]] Expected<CameraPath> ReadCameraPath(const VideoRecord& video, std::optional<double> ground_m);

  ApiOptions options_;
  std::unique_ptr<IndexView> index_;
  std::unique_ptr<AccessControl> access_;
  VideoFiles videos_;
  CopyFolder copies_;
  StaticFiles page_;
  std::mutex camera_mutex_;
  ByteCache camera_paths_;
  UploadFolder uploads_;
  std::unique_ptr<LiveService> live_;  // last: its threads use what is above
};

}  // namespace victorious

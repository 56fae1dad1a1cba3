// The routes of `victorious serve`: from a request to its response. api/openapi.json describes them, api_routes.cc has
// the one table of them. No network here: http_server.h calls Handle from several threads.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <expected>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <semaphore>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "victorious/base/cancel.h"
#include "victorious/cluster/cluster_status.h"
#include "victorious/pipeline/camera_states.h"
#include "victorious/serve/access_control.h"
#include "victorious/serve/api_error.h"
#include "victorious/serve/base_map.h"
#include "victorious/serve/camera_path.h"
#include "victorious/serve/copy_folder.h"
#include "victorious/serve/http_message.h"
#include "victorious/serve/index_view.h"
#include "victorious/serve/live_service.h"
#include "victorious/serve/once_cache.h"
#include "victorious/serve/request_target.h"
#include "victorious/serve/static_files.h"
#include "victorious/serve/upload_folder.h"
#include "victorious/serve/video_files.h"
#include "victorious/serve/video_roots.h"
#include "victorious/store/export_json.h"
#include "victorious/store/threshold_store.h"
#include "victorious/types/object_model.h"

namespace victorious {

/// What the page offers to try on an empty index.
struct SampleFiles {
  std::filesystem::path scene;   ///< that `victorious simulate` makes a flight of
  std::filesystem::path object;  ///< CAD file of an object of the scene
};

struct ApiOptions {
  std::string index;                      ///< by the name that OpenStore takes; without a password
  std::filesystem::path models;           ///< model library, for the images of views; empty: none
  std::optional<std::string> telemetry;   ///< of the only video that the index has; std::nullopt: found by itself
  std::filesystem::path web;              ///< the built page
  std::filesystem::path uploads;          ///< where uploaded files go; created when it is needed
  std::filesystem::path copies;           ///< where the videos go that are made for users; created when it is needed
  std::filesystem::path categories = {};  ///< category model that videos are searched for, and that reviews refine
  BaseMap base_map = {};
  /// Folders whose files may be opened where the index names them, besides those of the index, of uploads and copies,
  /// and the current one.
  std::vector<std::filesystem::path> videos = {};
  std::vector<std::filesystem::path> secrets = {};  ///< files that are never opened for the index: a private key
  std::optional<SampleFiles> sample = {};           ///< std::nullopt: none
  std::uint64_t max_copies_bytes = CopyFolder::Limits().max_bytes;
  std::uint64_t max_upload_bytes = std::uint64_t{50} << 30;
  ServerIdentity server;
};

/// Thread-safe.
class Api {
 public:
  /// A request, as the handler of its route gets it.
  struct Call {
    const HttpRequest& request;
    const std::vector<std::string>& parameters;  ///< the segments in the places of {…}, in their order
    QueryReader& query;                          ///< checked to be empty for a route without kHasQuery
    const Caller& caller;
    int port = 0;
    const CancelToken& cancel;  ///< ends what takes long
  };
  using Handler = ApiExpected<HttpResponse> (Api::*)(const Call& call);

  /// What a request can be for. The role stands between address and handler, so that none can be left out.
  struct Route {
    HttpMethod method;          ///< kGet answers HEAD, too
    std::string_view path;      ///< as in api/openapi.json; {…} stands for one segment
    std::optional<Role> least;  ///< that an account needs; std::nullopt: open to everybody
    Handler handler;
    bool has_query = false;  ///< the handler reads parameters of the query, and refuses others
    bool is_slow = false;    ///< it reads a video: waits for its turn (SlowResponse)
  };

  [[nodiscard]] static std::span<const Route> Routes();

  /// @param cancel  ends long reading of videos; must outlive the Api
  /// Errors: those of IndexView::Open and AccessControl::Open; kInvalidArgument for telemetry with several videos;
  /// kNotFound for a models folder that is not there, or without victorious-decoder.
  [[nodiscard]] static Expected<std::unique_ptr<Api>> Open(ApiOptions options, const CancelToken& cancel);

  /// @param port  of the server: the Host header must name it
  [[nodiscard]] HttpResponse Handle(const HttpRequest& request, int port);

  /// The same, but of a route that is slow a SlowResponse, once the request is admitted.
  [[nodiscard]] HttpResponse Begin(const HttpRequest& request, int port);

  /// Where the body of an upload goes, or the response that refuses it.
  [[nodiscard]] std::expected<UploadPlan, HttpResponse> PlanUpload(const HttpRequest& request, int port);

 private:
  Api(ApiOptions options, std::unique_ptr<IndexView> index, const CancelToken& cancel);

  using Segments = std::span<const std::string>;

  struct RouteMatch {
    const Route* route = nullptr;
    std::vector<std::string> parameters;
  };
  [[nodiscard]] static std::optional<RouteMatch> FindRoute(HttpMethod method, Segments segments);
  /// The methods of an address, as the header Allow names them; empty: there is no such address.
  [[nodiscard]] static std::string AllowedMethods(Segments segments);

  /// A request that may be answered.
  struct Admitted {
    RequestTarget target;
    RouteMatch match;  ///< without a route: for a file of the page
    Caller caller;
  };
  /// Refuses what comes from elsewhere, what has no route, and whom its role does not admit.
  [[nodiscard]] std::expected<Admitted, HttpResponse> Admit(const HttpRequest& request, int port);
  [[nodiscard]] HttpResponse Answer(const HttpRequest& request, const Admitted& admitted, int port,
                                    const CancelToken& cancel);
  ApiExpected<HttpResponse> AskHandler(const HttpRequest& request, const Admitted& admitted, int port,
                                       const CancelToken& cancel);

  /// A video of the index, and the lists that hold it.
  struct ListedVideo {
    std::shared_ptr<const IndexLists> lists;
    const VideoRecord* record = nullptr;
  };
  /// Error: kNotFound.
  ApiExpected<ListedVideo> FindVideo(std::string_view id);
  /// The video of the member "video_id". Error: kInvalidArgument.
  ApiExpected<ListedVideo> ReadVideo(const nlohmann::json& body);
  /// Error: kNotFound.
  ApiExpected<TriageObject> FindObject(std::string_view id);

  // Handlers.
  ApiExpected<HttpResponse> Session(const Call& call);
  ApiExpected<HttpResponse> LogIn(const Call& call);
  ApiExpected<HttpResponse> LogOut(const Call& call);
  ApiExpected<HttpResponse> Project(const Call& call);
  ApiExpected<HttpResponse> BaseMapFile(const Call& call);
  ApiExpected<HttpResponse> Audit(const Call& call);
  ApiExpected<HttpResponse> Videos(const Call& call);
  ApiExpected<HttpResponse> Video(const Call& call);
  ApiExpected<HttpResponse> VideoTimes(const Call& call);
  ApiExpected<HttpResponse> VideoSightings(const Call& call);
  ApiExpected<HttpResponse> VideoCamera(const Call& call);
  ApiExpected<HttpResponse> VideoFile(const Call& call);
  ApiExpected<HttpResponse> VideoCopy(const Call& call);
  ApiExpected<HttpResponse> VideoFrame(const Call& call);
  // In api_cluster.cc.
  ApiExpected<HttpResponse> Cluster(const Call& call);
  // In api_evidence.cc.
  ApiExpected<HttpResponse> ModelViews(const Call& call);
  ApiExpected<HttpResponse> ViewImage(const Call& call);
  ApiExpected<HttpResponse> Evidence(const Call& call);
  // In api_jobs.cc.
  ApiExpected<HttpResponse> Upload(const Call& call);
  ApiExpected<HttpResponse> Jobs(const Call& call);
  ApiExpected<HttpResponse> SubmitJob(const Call& call);
  ApiExpected<HttpResponse> CancelJob(const Call& call);
  ApiExpected<HttpResponse> RetryJob(const Call& call);
  ApiExpected<HttpResponse> RemoveJob(const Call& call);
  ApiExpected<HttpResponse> JobFile(const Call& call);
  ApiExpected<HttpResponse> Events(const Call& call);
  // In api_objects.cc.
  ApiExpected<HttpResponse> Objects(const Call& call);
  ApiExpected<HttpResponse> Counts(const Call& call);
  ApiExpected<HttpResponse> Tile(const Call& call);
  ApiExpected<HttpResponse> Object(const Call& call);
  ApiExpected<HttpResponse> ObjectSightings(const Call& call);
  ApiExpected<HttpResponse> Thumbnail(const Call& call);
  ApiExpected<HttpResponse> Decisions(const Call& call);
  ApiExpected<HttpResponse> PutReview(const Call& call);
  // In api_thresholds.cc.
  ApiExpected<HttpResponse> Thresholds(const Call& call);
  ApiExpected<HttpResponse> PutThreshold(const Call& call);

  /// The thresholds in force.
  ApiExpected<std::vector<ModelMinScore>> MinScores();
  /// The body of the answer, made once for all that ask for it between two changes.
  [[nodiscard]] Expected<std::shared_ptr<const std::string>> ThresholdList();
  [[nodiscard]] Expected<std::string> MakeThresholdList(const IndexLists& lists);
  /// The filters of the list, of its counts and of tiles.
  ApiExpected<ObjectQuery> ReadObjectQuery(QueryReader& query, const Caller& caller);

  /// The input of a job (job_runner.h), from the body of the request for it.
  ApiExpected<Json> JobInput(JobKind kind, const nlohmann::json& body, const CancelToken& cancel);
  ApiExpected<Json> IndexInput(const nlohmann::json& body);
  ApiExpected<Json> ModelInput(const nlohmann::json& body, const CancelToken& cancel);
  ApiExpected<Json> CopyInput(const nlohmann::json& body);
  ApiExpected<Json> ClipInput(const nlohmann::json& body);
  ApiExpected<Json> RefineInput(const nlohmann::json& body);
  /// Errors: kUnsupported without a sample, or if the index has a video.
  ApiExpected<Json> SampleInput(const nlohmann::json& body);
  /// Submits three jobs: the model of its object, the flight, its search. Returns the second.
  ApiExpected<HttpResponse> SubmitSample(const Json& input, const std::string& actor);
  /// Whether the library has a model.
  [[nodiscard]] bool HasModels() const;
  [[nodiscard]] bool HasSample(const IndexLists& lists) const;
  /// Fails with kConflict if there is nothing that a video could be searched for, nor will be.
  ApiStatus CheckHasTargets();
  /// The job of an id in the address. Errors: kNotFound; those of LiveService::Find.
  ApiExpected<JobRecord> FindJob(const std::string& id);
  /// Fails with kConflict if a job that reads the index would not do what was asked for: it names what has changed.
  ApiStatus CheckStillValid(const JobRecord& job);
  /// A listed job that has made what is asked for; std::nullopt: none, or its file was removed.
  ApiExpected<std::optional<JobRecord>> FindMade(const NewJob& asked);
  /// Removes what was uploaded for a removed job, unless another job or a video of the index needs it.
  [[nodiscard]] Status RemoveUploads(const JobRecord& removed);
  // In api_follow.cc.
  ApiExpected<Json> LiveInput(const nlohmann::json& body);
  ApiExpected<Json> TrackInput(const nlohmann::json& body, const CancelToken& cancel);
  /// Writes a frame of a video as an image among the uploads.
  ApiExpected<std::filesystem::path> SaveFrame(const nlohmann::json& body, const CancelToken& cancel);
  /// The file that a job has made, to be saved under the job's title.
  ApiExpected<HttpResponse> SendJobFile(const HttpRequest& request, const JobRecord& job, const std::string& name);
  ApiExpected<HttpResponse> SendMade(const HttpRequest& request, const std::string& name);
  ApiExpected<HttpResponse> Sightings(SightingFilter filter, QueryReader& query);
  /// Errors: kNotFound without a library, for a category, or without the model; kConflict for another model of this
  /// name.
  ApiExpected<std::shared_ptr<const ObjectModel>> LoadModel(const ModelRecord& record);
  /// The model of an id in the address. Errors: those of LoadModel; kNotFound.
  ApiExpected<std::shared_ptr<const ObjectModel>> LoadModelOf(std::string_view id);
  ApiExpected<SightingRecord> ReadSighting(std::int64_t object, QueryReader& query);
  /// The key of an object (object_key.h); null without a sighting.
  ApiExpected<Json> KeyOf(const TriageObject& object, const IndexLists& lists, const IndexReader& reader);
  /// The objects that a key names: at most one. Error: kInvalidArgument for a text that is no key.
  ApiExpected<std::vector<TriageObject>> ObjectsOfKey(std::string_view key, const IndexLists& lists,
                                                      const IndexReader& reader);
  /// The telemetry file that was given for a video, to the server or when it was indexed; std::nullopt: that of a video
  /// is in it or beside it.
  /// @param warn  receives a line if the file is gone; may be empty
  [[nodiscard]] std::optional<std::string> TelemetryOf(const VideoRecord& video, const WarningSink& warn = {}) const;
  [[nodiscard]] Expected<CameraStates> LoadCameras(const VideoRecord& video, const std::filesystem::path& path,
                                                   const TelemetryOptions& options, const WarningSink& warn,
                                                   const CancelToken& cancel);
  /// The body of an answer, at most one at a time.
  [[nodiscard]] Expected<std::string> MakeEvidence(const SightingRecord& sighting, const VideoRecord& video,
                                                   const std::string& options_json, const ObjectModel& model,
                                                   const CancelToken& cancel);
  [[nodiscard]] Expected<CameraPath> ReadCameraPath(const VideoRecord& video, std::optional<double> ground_m,
                                                    const CancelToken& cancel);

  ApiOptions options_;
  const CancelToken& cancel_;
  std::optional<std::int64_t> telemetry_video_;  ///< id of the video that options_.telemetry belongs to
  std::unique_ptr<IndexView> index_;
  std::unique_ptr<AccessControl> access_;
  std::mutex cluster_mutex_;
  std::unique_ptr<ClusterReader> cluster_;  ///< opened by the first request for it
  std::string cluster_body_;                ///< of the last answer, for those who ask at once
  std::chrono::steady_clock::time_point cluster_read_;
  std::mutex thresholds_mutex_;
  std::unique_ptr<ThresholdStore> thresholds_;  ///< for what is put into force; readers have their own
  VideoRoots roots_;
  VideoFiles videos_;
  CopyFolder copies_;
  StaticFiles page_;
  OnceCache<std::string> camera_paths_;        ///< bodies of answers
  OnceCache<std::string> threshold_lists_;     ///< the body of the answer, by the lists and `own_changes_`
  std::atomic<std::int64_t> own_changes_ = 0;  ///< of reviews and thresholds, which the lists show a little later
  OnceCache<CameraStates> cameras_;            ///< by the video's content and the telemetry's options
  OnceCache<std::string> evidence_;            ///< bodies of answers
  OnceCache<ObjectModel> models_;              ///< by name and state of the file; the files are mapped
  std::counting_semaphore<> evidence_slots_{1};
  UploadFolder uploads_;
  std::unique_ptr<LiveService> live_;  // last: its threads use what is above
};

}  // namespace victorious

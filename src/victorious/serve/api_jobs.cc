// The routes of uploads, jobs and events.
#include <algorithm>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/base/json.h"
#include "victorious/base/utc.h"
#include "victorious/model/model_library.h"
#include "victorious/serve/api.h"
#include "victorious/serve/api_json.h"
#include "victorious/serve/api_response.h"
#include "victorious/serve/request_guard.h"

namespace victorious {
namespace {

using Body = nlohmann::json;

// The value of a member that must be a text.
ApiExpected<std::string> ReadText(const Body& body, const std::string& name) {
  const auto found = body.find(name);
  if (found != body.end() && found->is_string()) return found->get<std::string>();
  return FailField(name, name + ": must be a text");
}

ApiStatus CheckMembers(const Body& body, std::initializer_list<std::string_view> names) {
  for (const auto& [name, value] : body.items()) {
    if (std::ranges::find(names, name) == names.end()) return FailField(name, name + ": not a member of such a job");
  }
  return {};
}

}  // namespace

std::expected<UploadPlan, HttpResponse> Api::PlanUpload(const HttpRequest& request, int port) {
  const auto admitted = Admit(request, port);
  if (!admitted) return std::unexpected(admitted.error());
  const auto plan = [&]() -> ApiExpected<UploadPlan> {
    const RequestTarget& target = admitted->target;
    const bool is_upload = target.segments == std::vector<std::string>{"api", "v1", "uploads"};
    if (!is_upload) return NotFound("files are uploaded to /api/v1/uploads");
    if (!live_->has_jobs()) {
      return std::unexpected(
          ApiError(Error{ErrorCode::kPermissionDenied,
                         "this server takes no files: start `victorious serve` with --models DIR on an "
                         "index that can be written"}));
    }
    QueryReader query(target);
    const auto name = query.Text("name");
    VICTORIOUS_RETURN_IF_ERROR(query.CheckAllUsed());
    auto file = uploads_.Create(name.value_or(""));
    if (!file) return std::unexpected(ApiError(file.error(), "name"));
    return UploadPlan{.file = *std::move(file), .max_bytes = options_.max_upload_bytes};
  }();
  if (!plan) return std::unexpected(ErrorResponse(plan.error()));
  return *plan;
}

ApiExpected<HttpResponse> Api::Upload(const HttpRequest& request, const Caller& caller) {
  if (!request.upload) {
    return std::unexpected(
        ApiError(Error{ErrorCode::kUnsupported, "the body must have the content type application/octet-stream"},
                 "Content-Type"));
  }
  std::error_code error;
  const auto bytes = std::filesystem::file_size(*request.upload, error);
  if (error) return std::unexpected(ApiError(ErrorFromErrno(error.value(), request.upload->string())));
  const Json upload = {
      {"id", UploadFolder::IdOf(*request.upload)}, {"name", request.upload->filename().string()}, {"bytes", bytes}};
  VICTORIOUS_RETURN_IF_ERROR(access_->Log(caller, "upload", upload["name"].get<std::string>(), Dump(upload)));
  return JsonResponse(upload);
}

ApiExpected<HttpResponse> Api::Jobs() {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<JobRecord> jobs, live_->Jobs());
  return JsonResponse(JobsToJson(jobs, NowUtcMicroseconds()));
}

ApiExpected<Json> Api::CopyInput(std::int64_t video) {
  VICTORIOUS_ASSIGN_OR_RETURN(const auto lists, index_->Lists());
  const VideoRecord* record = lists->Video(video);
  if (record == nullptr) return FailField("video_id", "video_id: not a video of the index");
  VICTORIOUS_ASSIGN_OR_RETURN(const std::filesystem::path path, videos_.Find(*record));
  if (videos_.HasCopy(*record)) {
    return std::unexpected(
        ApiError(Error{ErrorCode::kAlreadyExists, fmt::format("video {} has a copy already", video)}, "video_id"));
  }
  const std::filesystem::path copy = videos_.CopyPath(*record);
  std::error_code error;
  std::filesystem::create_directories(copy.parent_path(), error);
  if (error) return std::unexpected(ApiError(ErrorFromErrno(error.value(), "create " + copy.parent_path().string())));
  return Json{{"video", path.string()}, {"copy", copy.string()}};
}

ApiExpected<HttpResponse> Api::PutJob(const HttpRequest& request, const Caller& caller) {
  constexpr std::size_t kMaxFiles = 200;
  const auto body = ParseJson(request.body);
  if (!body) return std::unexpected(ApiError(body.error()));
  if (!body->is_object()) return FailField("", "the body must be an object");
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string kind, ReadText(*body, "kind"));
  Json input;
  if (kind == "index") {
    VICTORIOUS_RETURN_IF_ERROR(CheckMembers(*body, {"kind", "video_id", "upload", "telemetry"}));
    if (body->contains("video_id") == body->contains("upload")) {
      return FailField("upload", "give a video_id of the index or an upload");
    }
    if (body->contains("video_id")) {
      const Body& id = (*body)["video_id"];
      VICTORIOUS_ASSIGN_OR_RETURN(const auto lists, index_->Lists());
      const VideoRecord* video = id.is_number_integer() ? lists->Video(id.get<std::int64_t>()) : nullptr;
      if (video == nullptr) return FailField("video_id", "video_id: not a video of the index");
      VICTORIOUS_ASSIGN_OR_RETURN(const std::filesystem::path path, videos_.Find(*video));
      input["video"] = path.string();
    } else {
      VICTORIOUS_ASSIGN_OR_RETURN(const std::string upload, ReadText(*body, "upload"));
      const auto path = uploads_.Find(upload);
      if (!path) return std::unexpected(ApiError(path.error(), "upload"));
      input["video"] = path->string();
    }
    if (body->contains("telemetry")) {
      VICTORIOUS_ASSIGN_OR_RETURN(const std::string upload, ReadText(*body, "telemetry"));
      const auto path = uploads_.Find(upload);
      if (!path) return std::unexpected(ApiError(path.error(), "telemetry"));
      input["telemetry"] = path->string();
    }
  } else if (kind == "model") {
    VICTORIOUS_RETURN_IF_ERROR(CheckMembers(*body, {"kind", "name", "uploads", "length_m"}));
    VICTORIOUS_ASSIGN_OR_RETURN(const std::string name, ReadText(*body, "name"));
    const Status is_new = ModelLibrary(options_.models).CheckNewName(name);
    if (!is_new) return std::unexpected(ApiError(is_new.error(), "name"));
    const auto uploads = body->find("uploads");
    if (uploads == body->end() || !uploads->is_array() || uploads->empty() || uploads->size() > kMaxFiles) {
      return FailField("uploads", fmt::format("uploads: must be a list of 1 to {} uploads", kMaxFiles));
    }
    for (const Body& one : *uploads) {
      const auto path = uploads_.Find(one.is_string() ? one.get<std::string>() : "");
      if (!path) return std::unexpected(ApiError(path.error(), "uploads"));
      input["files"].push_back(path->string());
    }
    input["name"] = name;
    if (const auto length = body->find("length_m"); length != body->end() && !length->is_null()) {
      if (!length->is_number() || !(length->get<double>() > 0)) {
        return FailField("length_m", "length_m: must be a number above 0");
      }
      input["length_m"] = length->get<double>();
    }
  } else if (kind == "copy") {
    VICTORIOUS_RETURN_IF_ERROR(CheckMembers(*body, {"kind", "video_id"}));
    const auto id = body->find("video_id");
    const bool has_id = id != body->end() && id->is_number_integer();
    VICTORIOUS_ASSIGN_OR_RETURN(input, CopyInput(has_id ? id->get<std::int64_t>() : -1));
    // Several viewers ask for the same one.
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<JobRecord> jobs, live_->Jobs());
    for (const JobRecord& job : jobs) {
      const bool is_open = job.state == JobState::kQueued || job.state == JobState::kRunning;
      if (is_open && job.kind == kind && job.input_json == Dump(input)) {
        return JsonResponse(JobToJson(job, NowUtcMicroseconds()));
      }
    }
  } else {
    return FailField("kind", fmt::format("kind \"{}\": must be index, model or copy", kind));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const JobRecord job, live_->Put(kind, Dump(input)));
  VICTORIOUS_RETURN_IF_ERROR(access_->Log(caller, "job", fmt::format("job {}", job.id), Dump(input)));
  return JsonResponse(JobToJson(job, NowUtcMicroseconds()));
}

ApiExpected<HttpResponse> Api::CancelJob(std::string_view number, const Caller& caller) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t id, ParseId(number, "job"));
  VICTORIOUS_ASSIGN_OR_RETURN(const JobRecord job, live_->Cancel(id));
  VICTORIOUS_RETURN_IF_ERROR(access_->Log(caller, "cancel_job", fmt::format("job {}", job.id), ""));
  return JsonResponse(JobToJson(job, NowUtcMicroseconds()));
}

ApiExpected<HttpResponse> Api::Events() {
  return HttpResponse{.content_type = "text/event-stream",
                      .headers = {{"Cache-Control", "no-store"}},
                      .body = {},
                      .file = {},
                      .events = live_->Listen()};
}

}  // namespace victorious

#include "victorious/apps/serve/job_routes.h"

#include <algorithm>
#include <cctype>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/apps/serve/api_json.h"
#include "victorious/apps/serve/api_response.h"
#include "victorious/apps/serve/byte_range.h"
#include "victorious/apps/serve/file_response.h"
#include "victorious/apps/serve/job_body.h"
#include "victorious/apps/serve/source_guard.h"
#include "victorious/apps/serve/static_files.h"
#include "victorious/base/file.h"
#include "victorious/base/json.h"
#include "victorious/base/log.h"
#include "victorious/base/utc.h"
#include "victorious/object/model/model_library.h"
#include "victorious/show/drawn_video.h"

namespace victorious {

namespace {

AccountQuota::Limits LimitsOf(std::size_t in_all) {
  constexpr std::size_t kAccounts = 5;  // that fill it up together
  return {.in_all = in_all, .an_account = std::max<std::size_t>(1, in_all / kAccounts)};
}

// A reason tells what answers at an address of the server's network.
SourceReasons ReasonsFor(const Caller& caller) {
  return caller.May(Role::kAdmin) ? SourceReasons::kShown : SourceReasons::kHidden;
}

bool IsOpen(const JobRecord& job) { return job.state == WorkState::kQueued || job.state == WorkState::kRunning; }

}  // namespace

JobRoutes::JobRoutes(const Needs& needs)
    : needs_(needs),
      upload_quota_("uploads without a job", LimitsOf(needs.options.max_uploads)),
      job_quota_("open jobs", LimitsOf(needs.options.max_jobs)) {}

ApiExpected<UploadPlan> JobRoutes::PlanUpload(const RequestTarget& target, const Caller& caller) {
  if (!needs_.live.has_jobs()) {
    return std::unexpected(ApiError(Error{
        ErrorCode::kPermissionDenied,
        "this server takes no files: start `victorious serve` with --models DIR on an index that can be written"}));
  }
  QueryReader query(target);
  const auto name = query.Text("name");
  VICTORIOUS_RETURN_IF_ERROR(query.CheckAllUsed());
  const std::scoped_lock lock(quota_mutex_);
  VICTORIOUS_ASSIGN_OR_RETURN(const std::set<std::string> used, UsedUploads());
  std::set<std::string> unused;
  for (const UploadFolder::Listed& upload : needs_.uploads.List()) {
    if (used.contains(upload.id)) continue;
    if (std::filesystem::file_time_type::clock::now() - upload.written < needs_.options.upload_expiry) {
      unused.insert(upload.id);
    } else {
      needs_.uploads.Remove(upload.id);
    }
  }
  VICTORIOUS_RETURN_IF_ERROR(upload_quota_.Check(unused, caller.name()));
  auto file = needs_.uploads.Create(name.value_or(""));
  if (file) upload_quota_.Add(UploadFolder::IdOf(*file), caller.name());
  if (!file) return std::unexpected(ApiError(file.error(), "name"));
  return UploadPlan{.file = *std::move(file), .max_bytes = needs_.options.max_upload_bytes};
}

ApiExpected<HttpResponse> JobRoutes::Upload(const ApiCall& call) {
  const HttpRequest& request = call.request;
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
  VICTORIOUS_RETURN_IF_ERROR(
      needs_.access.Log(call.caller, "upload", upload["name"].get<std::string>(), DumpJson(upload)));
  return JsonResponse(upload);
}

ApiExpected<HttpResponse> JobRoutes::List(const ApiCall& call) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<JobRecord> jobs, needs_.live.Jobs());
  return JsonResponse(JobsToJson(jobs, NowUtcMicroseconds(), ReasonsFor(call.caller)));
}

ApiExpected<HttpResponse> JobRoutes::Submit(const ApiCall& call) {
  const auto body = ParseJson(call.request.body);
  if (!body) return std::unexpected(ApiError(body.error()));
  if (!body->is_object()) return FailField("", "the body must be an object");
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string name, ReadText(*body, "kind"));
  const std::optional<JobKind> kind = FromText(kJobKindTexts, name);
  if (!kind) {
    return FailField(
        "kind",
        fmt::format("The kind \"{}\" must be one of index, live, model, copy, clip, track, refine, sample, remove",
                    name));
  }
  if (*kind == JobKind::kIndex || *kind == JobKind::kLive) VICTORIOUS_RETURN_IF_ERROR(CheckHasTargets());
  VICTORIOUS_ASSIGN_OR_RETURN(const Json input, needs_.inputs.Make(*kind, *body, call.cancel));
  if (*kind == JobKind::kRemove && !call.caller.May(Role::kAdmin)) {
    return std::unexpected(
        ApiError(Error{ErrorCode::kPermissionDenied, "only an administrator may remove a video or a model"}));
  }
  if (*kind == JobKind::kLive) VICTORIOUS_RETURN_IF_ERROR(CheckMayOpen(DumpJson(input), call.caller));
  const NewJob asked{.kind = *kind,
                     .input_json = DumpJson(input),
                     .now_us = NowUtcMicroseconds(),
                     .actor = call.caller.name(),
                     .logged = *kind == JobKind::kLive ? DumpJson(Json({{"title", input["title"]}})) : ""};
  // What it said of its marks is shown again, with the file.
  if (*kind == JobKind::kRefine) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<JobRecord> made, FindMade(asked));
    if (made) return JsonResponse(JobToJson(*made, NowUtcMicroseconds()));
  }
  const std::scoped_lock lock(quota_mutex_);
  VICTORIOUS_RETURN_IF_ERROR(CheckQuota(call.caller));
  if (*kind == JobKind::kSample) return SubmitSample(input, call.caller.name());
  // Several viewers ask for the same file.
  VICTORIOUS_ASSIGN_OR_RETURN(const JobRecord job,
                              MakesFile(*kind) ? needs_.live.SubmitOnce(asked) : needs_.live.Submit(asked));
  job_quota_.Add(std::to_string(job.id), call.caller.name());
  return JsonResponse(JobToJson(job, NowUtcMicroseconds()));
}

ApiExpected<HttpResponse> JobRoutes::SubmitSample(const Json& input, const std::string& actor) {
  const auto submit = [&](JobKind kind, const Json& one) {
    return needs_.live.Submit(
        {.kind = kind, .input_json = DumpJson(one), .now_us = NowUtcMicroseconds(), .actor = actor, .logged = ""});
  };
  const std::filesystem::path& object = needs_.options.sample->object;
  const std::string name = object.stem().string();
  if (ModelLibrary(needs_.options.models).CheckNewName(name)) {
    VICTORIOUS_RETURN_IF_ERROR(submit(JobKind::kModel, {{"name", name}, {"files", {object.string()}}}));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const JobRecord job, submit(JobKind::kSample, input));
  // They are worked off in this order.
  const std::filesystem::path folder = input["folder"].get<std::string>();
  VICTORIOUS_RETURN_IF_ERROR(submit(JobKind::kIndex, {{"video", (folder / "video.mp4").string()},
                                                      {"telemetry", (folder / "telemetry.csv").string()}}));
  return JsonResponse(JobToJson(job, NowUtcMicroseconds()));
}

ApiStatus JobRoutes::CheckHasTargets() {
  if (!needs_.live.has_jobs()) return {};  // submitting the job says so
  if (!needs_.options.categories.empty() || needs_.inputs.HasModels()) return {};
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<JobRecord> jobs, needs_.live.Jobs());
  const auto makes_model = [](const JobRecord& job) { return job.kind == JobKind::kModel && IsOpen(job); };
  if (std::ranges::any_of(jobs, makes_model)) return {};
  return std::unexpected(ApiError(
      Error{ErrorCode::kConflict,
            "there is nothing to search for: first add photos or a CAD file of an object, which make a model"}));
}

ApiExpected<std::optional<JobRecord>> JobRoutes::FindMade(const NewJob& asked) {
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<JobRecord> jobs, needs_.live.Jobs());
  const auto is_made = [&](const JobRecord& job) {
    if (job.kind != asked.kind || job.state != WorkState::kDone || job.input_json != asked.input_json) return false;
    const auto made = MadeFileOf(job);
    return made && needs_.copies.Has(made->filename().string());
  };
  const auto found = std::ranges::find_if(jobs, is_made);
  if (found == jobs.end()) return std::nullopt;
  return std::move(*found);
}

ApiExpected<HttpResponse> JobRoutes::Cancel(const ApiCall& call) {
  VICTORIOUS_ASSIGN_OR_RETURN(const JobRecord job, FindJob(call.parameters[0]));
  VICTORIOUS_ASSIGN_OR_RETURN(const JobRecord cancelled, needs_.live.Cancel(job.id, call.caller.name()));
  return JsonResponse(JobToJson(cancelled, NowUtcMicroseconds()));
}

ApiExpected<HttpResponse> JobRoutes::Retry(const ApiCall& call) {
  VICTORIOUS_ASSIGN_OR_RETURN(const JobRecord job, FindJob(call.parameters[0]));
  VICTORIOUS_RETURN_IF_ERROR(needs_.inputs.CheckStillValid(job, call.cancel));
  if (job.kind == JobKind::kLive) VICTORIOUS_RETURN_IF_ERROR(CheckMayOpen(job.input_json, call.caller));
  const std::scoped_lock lock(quota_mutex_);
  VICTORIOUS_RETURN_IF_ERROR(CheckQuota(call.caller));
  VICTORIOUS_ASSIGN_OR_RETURN(const JobRecord again, needs_.live.Retry(job.id, call.caller.name()));
  job_quota_.Add(std::to_string(again.id), call.caller.name());
  return JsonResponse(JobToJson(again, NowUtcMicroseconds()));
}

ApiExpected<HttpResponse> JobRoutes::Remove(const ApiCall& call) {
  VICTORIOUS_ASSIGN_OR_RETURN(const JobRecord job, FindJob(call.parameters[0]));
  VICTORIOUS_RETURN_IF_ERROR(needs_.live.Remove(job.id, call.caller.name()));
  if (const Status removed = RemoveUploads(job); !removed) LogWarning("uploads: {}", removed.error().message);
  return JsonResponse(Json::object());
}

Status JobRoutes::RemoveUploads(const JobRecord& removed) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::set<std::string> used, UsedUploads());
  for (const std::string& id : UploadFolder::IdsIn(removed.input_json)) {
    if (!used.contains(id)) needs_.uploads.Remove(id);
  }
  return {};
}

ApiStatus JobRoutes::CheckQuota(const Caller& caller) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<JobRecord> jobs, needs_.live.Jobs());
  std::set<std::string> open;
  for (const JobRecord& job : jobs) {
    if (IsOpen(job)) open.insert(std::to_string(job.id));
  }
  VICTORIOUS_RETURN_IF_ERROR(job_quota_.Check(open, caller.name()));
  return {};
}

ApiStatus JobRoutes::CheckMayOpen(const std::string& input_json, const Caller& caller) {
  // Without accounts, who asks has the rights of the server's user on this machine.
  if (caller.is_open && needs_.options.live_sources.empty()) return {};
  const auto input = ParseJson(input_json);
  const std::string url = input ? input->value("video", std::string()) : std::string();
  const Status status = CheckSource(url, needs_.options.live_sources);
  if (!status) return std::unexpected(ApiError(status.error(), "url"));
  return {};
}

Expected<std::set<std::string>> JobRoutes::UsedUploads() {
  std::set<std::string> used;
  const auto keep = [&](std::string_view text) { used.merge(UploadFolder::IdsIn(text)); };
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<JobRecord> jobs, needs_.live.Jobs());
  for (const JobRecord& job : jobs) keep(job.input_json);
  // Not the lists that are kept: a search may have added its video just now.
  VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, needs_.index.Borrow());
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<VideoRecord> videos, reader->sightings->Videos());
  for (const VideoRecord& video : videos) {
    keep(video.name);
    keep(video.telemetry);
  }
  return used;
}

ApiExpected<JobRecord> JobRoutes::FindJob(const std::string& id) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t number, ParseId(id, "job"));
  VICTORIOUS_ASSIGN_OR_RETURN(std::optional<JobRecord> job, needs_.live.Find(number));
  if (!job) return NotFound(fmt::format("there is no job {}", number));
  return *std::move(job);
}

ApiExpected<HttpResponse> JobRoutes::File(const ApiCall& call) {
  const std::string& number = call.parameters[0];
  const std::string& name = call.parameters[1];
  VICTORIOUS_ASSIGN_OR_RETURN(const JobRecord job, FindJob(number));
  const auto has_file = [&]() {
    if (job.state != WorkState::kDone || !MadeFileOf(job)) return false;
    if (job.kind == JobKind::kRefine) return name == "categories";
    return job.kind == JobKind::kClip && (name == "telemetry" || name == "clip");
  };
  if (!has_file()) return NotFound(fmt::format("job {} has no file {}", number, name));
  return SendJobFile(call.request, job, name);
}

ApiExpected<HttpResponse> JobRoutes::SendJobFile(const HttpRequest& request, const JobRecord& job,
                                                 const std::string& name) {
  // Whatever folder the queue names.
  const std::filesystem::path made = needs_.copies.PathOf(MadeFileOf(job).value().filename());
  std::error_code error;
  const auto send = [&](const std::filesystem::path& path, const std::string& type) {
    const auto bytes = std::filesystem::file_size(path, error);
    return FileResponse(request, path, error ? 0 : static_cast<std::int64_t>(bytes), type, FileEtag(path));
  };
  HttpResponse response;
  std::string saved = JobTitle(job);
  if (job.kind == JobKind::kRefine) {
    const auto use = needs_.copies.Take(made.filename().string());
    response = send(made, "application/octet-stream");
    if (!use || error) return NotFound("the refined category model was removed: refine the categories again");
    if (response.file) response.file->hold = use->hold;
    saved = std::filesystem::path(saved).stem().string() + "-refined.vcat";
  } else {
    VICTORIOUS_ASSIGN_OR_RETURN(response, SendMade(request, needs_.copies, made.filename().string()));
    if (name == "telemetry") {
      response = send(ClipTelemetryPath(made), "text/csv");
      if (error) return NotFound("the clip has no telemetry");
    }
    saved += name == "telemetry" ? ".telemetry.csv" : ".mp4";
  }
  // The name is of letters that every system takes, whatever the model and the video are called.
  std::ranges::replace_if(saved, [](unsigned char c) { return std::isalnum(c) == 0 && c != '-' && c != '.'; }, '_');
  response.headers.emplace_back("Content-Disposition", fmt::format("attachment; filename=\"{}\"", saved));
  return response;
}

ApiExpected<HttpResponse> JobRoutes::Events(const ApiCall& call) {
  return HttpResponse{.content_type = "text/event-stream",
                      .headers = {{"Cache-Control", "no-store"}},
                      .body = {},
                      .file = {},
                      .events = needs_.live.Listen(call.caller.is_open)};
}

}  // namespace victorious

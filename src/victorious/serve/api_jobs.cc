// The routes of uploads, jobs and events.
#include <algorithm>
#include <cctype>
#include <set>
#include <span>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/base/file.h"
#include "victorious/base/json.h"
#include "victorious/base/log.h"
#include "victorious/base/utc.h"
#include "victorious/model/model_library.h"
#include "victorious/pipeline/drawn_video.h"
#include "victorious/pipeline/review_marks.h"
#include "victorious/serve/api.h"
#include "victorious/serve/api_json.h"
#include "victorious/serve/api_response.h"
#include "victorious/serve/byte_range.h"
#include "victorious/serve/job_body.h"
#include "victorious/serve/request_guard.h"

namespace victorious {
namespace {

using Body = nlohmann::json;

// The value of a member that must be a text.
ApiExpected<std::string> ReadText(const Body& body, const std::string& name) {
  const auto found = body.find(name);
  if (found != body.end() && found->is_string()) return found->get<std::string>();
  return FailField(name, fmt::format("The {} must be a text", name));
}

}  // namespace

std::expected<UploadPlan, HttpResponse> Api::PlanUpload(const HttpRequest& request, int port) {
  const auto admitted = Admit(request, port);
  if (!admitted) return std::unexpected(admitted.error());
  const auto plan = [&]() -> ApiExpected<UploadPlan> {
    const RequestTarget& target = admitted->target;
    const bool is_upload = admitted->match.route != nullptr && admitted->match.route->handler == &Api::Upload;
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

ApiExpected<HttpResponse> Api::Upload(const Call& call) {
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
  VICTORIOUS_RETURN_IF_ERROR(access_->Log(call.caller, "upload", upload["name"].get<std::string>(), DumpJson(upload)));
  return JsonResponse(upload);
}

ApiExpected<HttpResponse> Api::Jobs(const Call& /*call*/) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<JobRecord> jobs, live_->Jobs());
  return JsonResponse(JobsToJson(jobs, NowUtcMicroseconds()));
}

ApiExpected<Api::ListedVideo> Api::ReadVideo(const Body& body) {
  VICTORIOUS_ASSIGN_OR_RETURN(auto lists, index_->Lists());
  const VideoRecord* video = lists->Video(ReadNumber(body, "video_id"));
  if (video == nullptr) return FailField("video_id", "The video is not in the index");
  return ListedVideo{.lists = std::move(lists), .record = video};
}

ApiExpected<Json> Api::JobInput(JobKind kind, const Body& body, const CancelToken& cancel) {
  switch (kind) {
    case JobKind::kIndex:
      return IndexInput(body);
    case JobKind::kModel:
      return ModelInput(body, cancel);
    case JobKind::kCopy:
      return CopyInput(body);
    case JobKind::kLive:
      return LiveInput(body);
    case JobKind::kTrack:
      return TrackInput(body, cancel);
    case JobKind::kRefine:
      return RefineInput(body);
    case JobKind::kSample:
      return SampleInput(body);
    case JobKind::kClip:
      break;
  }
  return ClipInput(body);
}

ApiExpected<Json> Api::IndexInput(const Body& body) {
  Json input;
  VICTORIOUS_RETURN_IF_ERROR(CheckMembers(body, {"kind", "video_id", "upload", "telemetry"}));
  if (body.contains("video_id") == body.contains("upload")) {
    return FailField("upload", "Give a video_id of the index or an upload");
  }
  if (body.contains("video_id")) {
    VICTORIOUS_ASSIGN_OR_RETURN(const ListedVideo video, ReadVideo(body));
    VICTORIOUS_ASSIGN_OR_RETURN(const std::filesystem::path path, videos_.Find(*video.record));
    input["video"] = path.string();
    // What was given when it was indexed is in the index, where the search finds it and says so.
    if (video.record->id == telemetry_video_) input["telemetry"] = *options_.telemetry;
  } else {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::string upload, ReadText(body, "upload"));
    const auto path = uploads_.Find(upload);
    if (!path) return std::unexpected(ApiError(path.error(), "upload"));
    input["video"] = path->string();
  }
  if (body.contains("telemetry")) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::string upload, ReadText(body, "telemetry"));
    const auto path = uploads_.Find(upload);
    if (!path) return std::unexpected(ApiError(path.error(), "telemetry"));
    input["telemetry"] = path->string();
  }
  return input;
}

ApiExpected<Json> Api::CopyInput(const Body& body) {
  VICTORIOUS_RETURN_IF_ERROR(CheckMembers(body, {"kind", "video_id"}));
  VICTORIOUS_ASSIGN_OR_RETURN(const ListedVideo video, ReadVideo(body));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::filesystem::path path, videos_.Find(*video.record));
  const std::string copy = CopyName(*video.record);
  if (copies_.Has(copy)) {
    return std::unexpected(ApiError(
        Error{ErrorCode::kAlreadyExists, fmt::format("video {} has a copy already", video.record->id)}, "video_id"));
  }
  VICTORIOUS_RETURN_IF_ERROR(copies_.Create());
  return Json{{"video", path.string()}, {"copy", copies_.PathOf(copy).string()}};
}

ApiExpected<std::filesystem::path> Api::SaveFrame(const Body& body, const CancelToken& cancel) {
  VICTORIOUS_ASSIGN_OR_RETURN(const ListedVideo video, ReadVideo(body));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto times_s, videos_.Times(*video.record, cancel));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t number, ReadFrame(body, std::ssize(*times_s)));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto image,
                              videos_.Frame(*video.record, (*times_s)[static_cast<std::size_t>(number)], cancel));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto path, uploads_.Create(fmt::format("frame-{}.jpg", number)));
  VICTORIOUS_RETURN_IF_ERROR(WriteFileAtomically(path, std::string_view(*image)));
  return path;
}

ApiExpected<Json> Api::ModelInput(const Body& body, const CancelToken& cancel) {
  constexpr std::size_t kMaxFiles = 200;
  VICTORIOUS_RETURN_IF_ERROR(CheckMembers(body, {"kind", "name", "uploads", "length_m", "video_id", "frame", "box"}));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string name, ReadText(body, "name"));
  const Status is_new = ModelLibrary(options_.models).CheckNewName(name);
  if (!is_new) return std::unexpected(ApiError(is_new.error(), "name"));
  Json input = {{"name", name}};
  if (const auto length = body.find("length_m"); length != body.end() && !length->is_null()) {
    if (!length->is_number() || !(length->get<double>() > 0)) {
      return FailField("length_m", "The length must be a number of metres above 0");
    }
    input["length_m"] = length->get<double>();
  }
  if (body.contains("video_id") == body.contains("uploads")) {
    return FailField("uploads", "Give uploads, or the video_id, frame and box of an object");
  }
  if (body.contains("video_id")) {
    VICTORIOUS_RETURN_IF_ERROR(CheckBox(body));
    VICTORIOUS_ASSIGN_OR_RETURN(const std::filesystem::path frame, SaveFrame(body, cancel));
    input["files"].push_back(frame.string());
    input["box"] = body.at("box");
    return input;
  }
  const Body& uploads = body.at("uploads");
  if (!uploads.is_array() || uploads.empty() || uploads.size() > kMaxFiles) {
    return FailField("uploads", fmt::format("Give 1 to {} files", kMaxFiles));
  }
  for (const Body& one : uploads) {
    const auto path = uploads_.Find(one.is_string() ? one.get<std::string>() : "");
    if (!path) return std::unexpected(ApiError(path.error(), "uploads"));
    input["files"].push_back(path->string());
  }
  return input;
}

ApiExpected<Json> Api::ClipInput(const Body& body) {
  VICTORIOUS_RETURN_IF_ERROR(CheckMembers(body, {"kind", "object_id", "video_id", "from_s", "to_s"}));
  VICTORIOUS_ASSIGN_OR_RETURN(const ListedVideo listed, ReadVideo(body));
  const VideoRecord* video = listed.record;
  VICTORIOUS_RETURN_IF_ERROR(videos_.Find(*video));
  const std::int64_t id = ReadNumber(body, "object_id");
  VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, index_->Borrow());
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<TriageObject> found, reader->objects->ObjectsById({&id, 1}));
  const bool is_seen = !found.empty() && std::ranges::any_of(found.front().moments, [&](const TrackletRecord& moment) {
    return moment.video == video->id;
  });
  if (!is_seen) return FailField("object_id", "The video does not show the object");
  Json input = {{"video", video->name}, {"object", id}};
  for (const char* name : {"from_s", "to_s"}) {
    const auto given = body.find(name);
    if (given == body.end() || given->is_null()) continue;
    if (!given->is_number()) return FailField(name, fmt::format("The time {} must be a number of seconds", name));
    input[name] = given->get<double>();
  }
  if (const auto telemetry = TelemetryOf(*video)) input["telemetry"] = *telemetry;
  const ModelRecord* model = listed.lists->Model(found.front().object.model);
  input["title"] = fmt::format("{}-{}-{}", model == nullptr ? "object" : model->name, id,
                               std::filesystem::path(video->name).stem().string());
  // Another search may give the number to another object, or find more of this one: then it is another clip.
  Json content = input;
  content["content"] = video->content_id;
  for (const TrackletRecord& moment : found.front().moments) {
    content["moments"].push_back({moment.id, moment.first_time_s, moment.last_time_s, moment.frames, moment.score});
  }
  const std::string text = DumpJson(content);
  VICTORIOUS_RETURN_IF_ERROR(copies_.Create());
  input["clip"] = copies_.PathOf(fmt::format("clip-{:016x}.mp4", Checksum(std::as_bytes(std::span(text))))).string();
  return input;
}

ApiExpected<Json> Api::RefineInput(const Body& body) {
  VICTORIOUS_RETURN_IF_ERROR(CheckMembers(body, {"kind"}));
  if (options_.categories.empty()) {
    return std::unexpected(ApiError(Error{
        ErrorCode::kUnsupported,
        "this server knows no category model: start `victorious serve` with --categories FILE, the one that the videos "
        "were searched for"}));
  }
  // The file stays as it is: searches go on with it until the server is started with the refined one.
  const std::filesystem::path& file = options_.categories;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string model, ReadFile(file));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, index_->Borrow());
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ReviewMark> marks, ListReviewMarks(*reader->sightings));
  // All that the refined model depends on: after another decision it is another file.
  Json content = {{"categories", Checksum(std::as_bytes(std::span(model)))}};
  for (const ReviewMark& mark : marks) {
    content["marks"].push_back({mark.category, mark.is_right, mark.video.content_id, mark.video.name, mark.time_s});
  }
  const std::string text = DumpJson(content);
  VICTORIOUS_RETURN_IF_ERROR(copies_.Create());
  const std::string name =
      fmt::format("{}{:016x}.vcat", RefinedPrefix(options_.index), Checksum(std::as_bytes(std::span(text))));
  // From now on it is in use, so that it is not removed before a job refers to it.
  static_cast<void>(copies_.Take(name));
  return Json{{"categories", file.string()}, {"refine", copies_.PathOf(name).string()}};
}

ApiExpected<std::optional<JobRecord>> Api::FindMade(const NewJob& asked) {
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<JobRecord> jobs, live_->Jobs());
  const auto is_made = [&](const JobRecord& job) {
    if (job.kind != asked.kind || job.state != WorkState::kDone || job.input_json != asked.input_json) return false;
    const auto made = MadeFileOf(job);
    return made && copies_.Has(made->filename().string());
  };
  const auto found = std::ranges::find_if(jobs, is_made);
  if (found == jobs.end()) return std::nullopt;
  return std::move(*found);
}

ApiExpected<HttpResponse> Api::JobFile(const Call& call) {
  const std::string& number = call.parameters[0];
  const std::string& name = call.parameters[1];
  VICTORIOUS_ASSIGN_OR_RETURN(const JobRecord job, FindJob(number));
  const auto has_file = [&]() {
    if (job.state != WorkState::kDone || !MadeFileOf(job)) return false;
    if (job.kind == JobKind::kTrack) return name == "track";
    if (job.kind == JobKind::kRefine) return name == "categories";
    return job.kind == JobKind::kClip && (name == "telemetry" || name == "clip");
  };
  if (!has_file()) return NotFound(fmt::format("job {} has no file {}", number, name));
  return SendJobFile(call.request, job, name);
}

ApiExpected<JobRecord> Api::FindJob(const std::string& id) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t number, ParseId(id, "job"));
  VICTORIOUS_ASSIGN_OR_RETURN(std::optional<JobRecord> job, live_->Find(number));
  if (!job) return NotFound(fmt::format("there is no job {}", number));
  return *std::move(job);
}

ApiExpected<HttpResponse> Api::SendJobFile(const HttpRequest& request, const JobRecord& job, const std::string& name) {
  // Whatever folder the queue names.
  const std::filesystem::path made = copies_.PathOf(MadeFileOf(job).value().filename());
  std::error_code error;
  const auto send = [&](const std::filesystem::path& path, const std::string& type) {
    const auto bytes = std::filesystem::file_size(path, error);
    return FileResponse(request, path, error ? 0 : static_cast<std::int64_t>(bytes), type, FileEtag(path));
  };
  if (job.kind == JobKind::kTrack) {
    // Its own lines are read by the page: no download.
    const auto use = copies_.Take(made.filename().string());
    HttpResponse response = send(made, "application/x-ndjson");
    if (!use || error) return NotFound("the track was removed to make room for others: box the object again");
    if (response.file) response.file->hold = use->hold;
    return response;
  }
  HttpResponse response;
  std::string saved = JobTitle(job);
  if (job.kind == JobKind::kRefine) {
    const auto use = copies_.Take(made.filename().string());
    response = send(made, "application/octet-stream");
    if (!use || error) return NotFound("the refined category model was removed: refine the categories again");
    if (response.file) response.file->hold = use->hold;
    saved = std::filesystem::path(saved).stem().string() + "-refined.vcat";
  } else {
    VICTORIOUS_ASSIGN_OR_RETURN(response, SendMade(request, made.filename().string()));
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

ApiExpected<HttpResponse> Api::SubmitJob(const Call& call) {
  const auto body = ParseJson(call.request.body);
  if (!body) return std::unexpected(ApiError(body.error()));
  if (!body->is_object()) return FailField("", "the body must be an object");
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string name, ReadText(*body, "kind"));
  const std::optional<JobKind> kind = FromText(kJobKindTexts, name);
  if (!kind) {
    return FailField(
        "kind",
        fmt::format("The kind \"{}\" must be one of index, live, model, copy, clip, track, refine, sample", name));
  }
  if (*kind == JobKind::kIndex || *kind == JobKind::kLive) VICTORIOUS_RETURN_IF_ERROR(CheckHasTargets());
  VICTORIOUS_ASSIGN_OR_RETURN(const Json input, JobInput(*kind, *body, call.cancel));
  if (*kind == JobKind::kSample) return SubmitSample(input, call.caller.name());
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
  // Several viewers ask for the same file.
  VICTORIOUS_ASSIGN_OR_RETURN(const JobRecord job, MakesFile(*kind) ? live_->SubmitOnce(asked) : live_->Submit(asked));
  return JsonResponse(JobToJson(job, NowUtcMicroseconds()));
}

ApiStatus Api::CheckHasTargets() {
  if (!live_->has_jobs()) return {};  // submitting the job says so
  if (!options_.categories.empty() || HasModels()) return {};
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<JobRecord> jobs, live_->Jobs());
  const auto makes_model = [](const JobRecord& job) {
    return job.kind == JobKind::kModel && (job.state == WorkState::kQueued || job.state == WorkState::kRunning);
  };
  if (std::ranges::any_of(jobs, makes_model)) return {};
  return std::unexpected(ApiError(
      Error{ErrorCode::kConflict,
            "there is nothing to search for: first add photos or a CAD file of an object, which make a model"}));
}

bool Api::HasModels() const {
  if (options_.models.empty()) return false;
  const auto names = ModelLibrary(options_.models).Names();
  return names && !names->empty();
}

bool Api::HasSample(const IndexLists& lists) const { return options_.sample && lists.videos.empty(); }

ApiExpected<Json> Api::SampleInput(const Body& body) {
  VICTORIOUS_RETURN_IF_ERROR(CheckMembers(body, {"kind"}));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto lists, index_->Lists());
  if (!HasSample(*lists)) {
    return std::unexpected(ApiError(
        Error{ErrorCode::kUnsupported, options_.sample ? "the index has videos: the sample is for an empty one"
                                                       : "the files of the sample are not beside the program"}));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const std::filesystem::path video, uploads_.Create("video.mp4"));
  return Json{{"scene", options_.sample->scene.string()}, {"folder", video.parent_path().string()}};
}

ApiExpected<HttpResponse> Api::SubmitSample(const Json& input, const std::string& actor) {
  const auto submit = [&](JobKind kind, const Json& one) {
    return live_->Submit(
        {.kind = kind, .input_json = DumpJson(one), .now_us = NowUtcMicroseconds(), .actor = actor, .logged = ""});
  };
  const std::filesystem::path& object = options_.sample->object;
  const std::string name = object.stem().string();
  if (ModelLibrary(options_.models).CheckNewName(name)) {
    VICTORIOUS_RETURN_IF_ERROR(submit(JobKind::kModel, {{"name", name}, {"files", {object.string()}}}));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const JobRecord job, submit(JobKind::kSample, input));
  // They are worked off in this order.
  const std::filesystem::path folder = input["folder"].get<std::string>();
  VICTORIOUS_RETURN_IF_ERROR(submit(JobKind::kIndex, {{"video", (folder / "video.mp4").string()},
                                                      {"telemetry", (folder / "telemetry.csv").string()}}));
  return JsonResponse(JobToJson(job, NowUtcMicroseconds()));
}

ApiExpected<HttpResponse> Api::CancelJob(const Call& call) {
  VICTORIOUS_ASSIGN_OR_RETURN(const JobRecord job, FindJob(call.parameters[0]));
  VICTORIOUS_ASSIGN_OR_RETURN(const JobRecord cancelled, live_->Cancel(job.id, call.caller.name()));
  return JsonResponse(JobToJson(cancelled, NowUtcMicroseconds()));
}

ApiStatus Api::CheckStillValid(const JobRecord& job) {
  if (job.kind != JobKind::kClip && job.kind != JobKind::kRefine) return {};
  // The name of the file holds all that it is made from (ClipInput, RefineInput).
  VICTORIOUS_ASSIGN_OR_RETURN(const Json input, ParseJson(job.input_json));
  Body body = {{"kind", ToText(job.kind)}};
  if (job.kind == JobKind::kClip) {
    VICTORIOUS_ASSIGN_OR_RETURN(const auto lists, index_->Lists());
    const auto video = std::ranges::find(lists->videos, input.value("video", ""), &VideoRecord::name);
    body["video_id"] = video == lists->videos.end() ? -1 : video->id;
    body["object_id"] = input.value("object", std::int64_t{-1});
    for (const char* name : {"from_s", "to_s"}) {
      if (input.contains(name)) body[name] = input[name];
    }
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const Json now, JobInput(job.kind, body, cancel_));
  if (DumpJson(now) == job.input_json) return {};
  return std::unexpected(
      ApiError(Error{ErrorCode::kConflict, job.kind == JobKind::kClip
                                               ? "Another search has changed the object since: ask for the clip anew"
                                               : "Other decisions were made since: refine the categories anew"}));
}

ApiExpected<HttpResponse> Api::RetryJob(const Call& call) {
  VICTORIOUS_ASSIGN_OR_RETURN(const JobRecord job, FindJob(call.parameters[0]));
  VICTORIOUS_RETURN_IF_ERROR(CheckStillValid(job));
  VICTORIOUS_ASSIGN_OR_RETURN(const JobRecord again, live_->Retry(job.id, call.caller.name()));
  return JsonResponse(JobToJson(again, NowUtcMicroseconds()));
}

ApiExpected<HttpResponse> Api::RemoveJob(const Call& call) {
  VICTORIOUS_ASSIGN_OR_RETURN(const JobRecord job, FindJob(call.parameters[0]));
  VICTORIOUS_RETURN_IF_ERROR(live_->Remove(job.id, call.caller.name()));
  if (const Status removed = RemoveUploads(job); !removed) LogWarning("uploads: {}", removed.error().message);
  return JsonResponse(Json::object());
}

Status Api::RemoveUploads(const JobRecord& removed) {
  std::set<std::string> unused = UploadFolder::IdsIn(removed.input_json);
  const auto keep = [&](std::string_view text) {
    for (const std::string& id : UploadFolder::IdsIn(text)) unused.erase(id);
  };
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<JobRecord> jobs, live_->Jobs());
  for (const JobRecord& job : jobs) keep(job.input_json);
  // Not the lists that are kept: a search may have added its video just now.
  VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, index_->Borrow());
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<VideoRecord> videos, reader->sightings->Videos());
  for (const VideoRecord& video : videos) {
    keep(video.name);
    keep(video.telemetry);
  }
  for (const std::string& id : unused) uploads_.Remove(id);
  return {};
}

ApiExpected<HttpResponse> Api::Events(const Call& /*call*/) {
  return HttpResponse{.content_type = "text/event-stream",
                      .headers = {{"Cache-Control", "no-store"}},
                      .body = {},
                      .file = {},
                      .events = live_->Listen()};
}

}  // namespace victorious

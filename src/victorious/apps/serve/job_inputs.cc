#include "victorious/apps/serve/job_inputs.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/apps/serve/index_lookup.h"
#include "victorious/apps/serve/job_body.h"
#include "victorious/apps/serve/job_runner.h"
#include "victorious/base/credentials.h"
#include "victorious/base/file.h"
#include "victorious/base/json.h"
#include "victorious/category/finder/review_marks.h"
#include "victorious/object/model/model_library.h"

namespace victorious {
namespace {

using Body = nlohmann::json;

// The video of the member "video_id". Error: kInvalidArgument.
ApiExpected<ListedVideo> ReadVideo(IndexView& index, const Body& body) {
  VICTORIOUS_ASSIGN_OR_RETURN(auto lists, index.Lists());
  const VideoRecord* video = lists->Video(ReadNumber(body, "video_id"));
  if (video == nullptr) return FailField("video_id", "The video is not in the index");
  return ListedVideo{.lists = std::move(lists), .record = video};
}

}  // namespace

ApiExpected<Json> JobInputs::Make(JobKind kind, const Body& body, const CancelToken& cancel) {
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
    case JobKind::kRemove:
      return RemoveInput(body);
    case JobKind::kClip:
      break;
  }
  return ClipInput(body);
}

ApiExpected<Json> JobInputs::RemoveInput(const Body& body) {
  VICTORIOUS_RETURN_IF_ERROR(CheckMembers(body, {"kind", "video_id", "model_id"}));
  if (body.contains("video_id") == body.contains("model_id")) {
    return FailField("video_id", "Give either a video_id or a model_id of the index");
  }
  if (body.contains("video_id")) {
    VICTORIOUS_ASSIGN_OR_RETURN(const ListedVideo video, ReadVideo(index_, body));
    return Json{{"video", video.record->name}};
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const auto lists, index_.Lists());
  const ModelRecord* model = lists->Model(ReadNumber(body, "model_id"));
  if (model == nullptr) return FailField("model_id", "The model is not in the index");
  return Json{{"model", model->name}};
}

ApiExpected<Json> JobInputs::IndexInput(const Body& body) {
  Json input;
  VICTORIOUS_RETURN_IF_ERROR(CheckMembers(body, {"kind", "video_id", "upload", "telemetry", "redo"}));
  if (body.contains("video_id") == body.contains("upload")) {
    return FailField("upload", "Give a video_id of the index or an upload");
  }
  if (body.contains("video_id")) {
    VICTORIOUS_ASSIGN_OR_RETURN(const ListedVideo video, ReadVideo(index_, body));
    VICTORIOUS_ASSIGN_OR_RETURN(const std::filesystem::path path, videos_.Find(*video.record));
    input["video"] = path.string();
    input["video_id"] = video.record->id;
    // What was given when it was indexed is in the index, where the search finds it and says so.
    if (const auto given = videos_.roots().GivenTelemetry(*video.record)) input["telemetry"] = *given;
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
  if (const auto redo = body.find("redo"); redo != body.end()) {
    if (!redo->is_boolean()) return FailField("redo", "Give redo as true or false");
    if (redo->get<bool>()) input["redo"] = true;
  }
  return input;
}

ApiExpected<Json> JobInputs::CopyInput(const Body& body) {
  VICTORIOUS_RETURN_IF_ERROR(CheckMembers(body, {"kind", "video_id"}));
  VICTORIOUS_ASSIGN_OR_RETURN(const ListedVideo video, ReadVideo(index_, body));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::filesystem::path path, videos_.Find(*video.record));
  const std::string copy = CopyName(*video.record);
  if (copies_.Has(copy)) {
    return std::unexpected(ApiError(
        Error{ErrorCode::kAlreadyExists, fmt::format("video {} has a copy already", video.record->id)}, "video_id"));
  }
  VICTORIOUS_RETURN_IF_ERROR(copies_.Create());
  return Json{{"video", path.string()}, {"copy", copies_.PathOf(copy).string()}};
}

ApiExpected<std::filesystem::path> JobInputs::SaveFrame(const Body& body, const CancelToken& cancel) {
  VICTORIOUS_ASSIGN_OR_RETURN(const ListedVideo video, ReadVideo(index_, body));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto times_s, videos_.Times(*video.record, cancel));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t number, ReadFrame(body, std::ssize(*times_s)));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto image,
                              videos_.Frame(*video.record, (*times_s)[static_cast<std::size_t>(number)], cancel));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto path, uploads_.Create(fmt::format("frame-{}.jpg", number)));
  VICTORIOUS_RETURN_IF_ERROR(WriteFileAtomically(path, std::string_view(*image)));
  return path;
}

ApiExpected<Json> JobInputs::ModelInput(const Body& body, const CancelToken& cancel) {
  constexpr std::size_t kMaxFiles = 200;
  VICTORIOUS_RETURN_IF_ERROR(
      CheckMembers(body, {"kind", "name", "uploads", "length_m", "video_id", "frame", "box", "boxes"}));
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
  if (body.contains("boxes")) {
    VICTORIOUS_RETURN_IF_ERROR(CheckBoxes(body, uploads.size()));
    input["boxes"] = body.at("boxes");
  }
  return input;
}

ApiExpected<Json> JobInputs::ClipInput(const Body& body) {
  VICTORIOUS_RETURN_IF_ERROR(CheckMembers(body, {"kind", "object_id", "video_id", "from_s", "to_s"}));
  VICTORIOUS_ASSIGN_OR_RETURN(const ListedVideo listed, ReadVideo(index_, body));
  const VideoRecord* video = listed.record;
  VICTORIOUS_RETURN_IF_ERROR(videos_.Find(*video));
  const std::int64_t id = ReadNumber(body, "object_id");
  VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, index_.Borrow());
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
  if (const auto telemetry = videos_.roots().Telemetry(*video)) input["telemetry"] = *telemetry;
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

ApiExpected<Json> JobInputs::RefineInput(const Body& body) {
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
  VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, index_.Borrow());
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

ApiExpected<Json> JobInputs::SampleInput(const Body& body) {
  VICTORIOUS_RETURN_IF_ERROR(CheckMembers(body, {"kind"}));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto lists, index_.Lists());
  if (!HasSample(*lists)) {
    return std::unexpected(ApiError(
        Error{ErrorCode::kUnsupported, options_.sample ? "the index has videos: the sample is for an empty one"
                                                       : "the files of the sample are not beside the program"}));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const std::filesystem::path video, uploads_.Create("video.mp4"));
  return Json{{"scene", options_.sample->scene.string()}, {"folder", video.parent_path().string()}};
}

ApiExpected<Json> JobInputs::LiveInput(const Body& body) {
  constexpr std::size_t kMaxBytes = 1000;
  VICTORIOUS_RETURN_IF_ERROR(CheckMembers(body, {"kind", "url"}));
  const auto found = body.find("url");
  const std::string url = found != body.end() && found->is_string() ? found->get<std::string>() : "";
  // Quotes would end the address in a message, and its password would be shown.
  const auto is_plain = [](unsigned char c) { return c > ' ' && c < 0x7f && c != '"' && c != '\''; };
  if (!IsLiveSource(url) || url.size() > kMaxBytes || !std::ranges::all_of(url, is_plain)) {
    return FailField("url",
                     "The address must begin with rtsp://, rtsps://, udp://, srt:// or rtp://, and have no spaces");
  }
  return Json{{"video", url}, {"title", WithoutCredentials(url)}};
}

ApiExpected<Json> JobInputs::TrackInput(const Body& body, const CancelToken& cancel) {
  constexpr std::size_t kMaxTypeBytes = 40;
  VICTORIOUS_RETURN_IF_ERROR(CheckMembers(body, {"kind", "video_id", "frame", "box", "type"}));
  VICTORIOUS_ASSIGN_OR_RETURN(const ListedVideo listed, ReadVideo(index_, body));
  const VideoRecord* video = listed.record;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::filesystem::path path, videos_.Find(*video));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto times_s, videos_.Times(*video, cancel));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t frame, ReadFrame(body, std::ssize(*times_s)));
  VICTORIOUS_RETURN_IF_ERROR(CheckBox(body));
  // The command takes the first frame at a time or later, and the table's times are rounded.
  constexpr double kRounding_s = 1e-4;
  const double at_s = std::max(0.0, (*times_s)[static_cast<std::size_t>(frame)] - kRounding_s);
  Json input = {{"video", path.string()}, {"video_id", video->id}, {"at_s", at_s}, {"box", body.at("box")}};
  std::string title = "box";
  if (const auto type = body.find("type"); type != body.end() && !type->is_null()) {
    const std::string word = type->is_string() ? type->get<std::string>() : "";
    const auto is_letter = [](unsigned char c) { return c >= ' ' && c != 0x7f; };
    if (word.empty() || word.size() > kMaxTypeBytes || !std::ranges::all_of(word, is_letter)) {
      return FailField("type", fmt::format("The type must be one line of at most {} bytes", kMaxTypeBytes));
    }
    input["type"] = word;
    title = word;
  }
  if (const auto telemetry = videos_.roots().Telemetry(*video)) input["telemetry"] = *telemetry;
  input["title"] = fmt::format("{} in {}", title, std::filesystem::path(video->name).filename().string());
  return input;
}

ApiStatus JobInputs::CheckStillValid(const JobRecord& job, const CancelToken& cancel) {
  if (job.kind != JobKind::kClip && job.kind != JobKind::kRefine) return {};
  // The name of the file holds all that it is made from (ClipInput, RefineInput).
  VICTORIOUS_ASSIGN_OR_RETURN(const Json input, ParseJson(job.input_json));
  Body body = {{"kind", ToText(job.kind)}};
  if (job.kind == JobKind::kClip) {
    VICTORIOUS_ASSIGN_OR_RETURN(const auto lists, index_.Lists());
    const auto video = std::ranges::find(lists->videos, input.value("video", ""), &VideoRecord::name);
    body["video_id"] = video == lists->videos.end() ? -1 : video->id;
    body["object_id"] = input.value("object", std::int64_t{-1});
    for (const char* name : {"from_s", "to_s"}) {
      if (input.contains(name)) body[name] = input[name];
    }
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const Json now, Make(job.kind, body, cancel));
  if (DumpJson(now) == job.input_json) return {};
  return std::unexpected(
      ApiError(Error{ErrorCode::kConflict, job.kind == JobKind::kClip
                                               ? "Another search has changed the object since: ask for the clip anew"
                                               : "Other decisions were made since: refine the categories anew"}));
}

bool JobInputs::HasModels() const {
  if (options_.models.empty()) return false;
  const auto names = ModelLibrary(options_.models).Names();
  return names && !names->empty();
}

bool JobInputs::HasSample(const IndexLists& lists) const { return options_.sample && lists.videos.empty(); }

}  // namespace victorious

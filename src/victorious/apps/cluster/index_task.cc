#include "victorious/apps/cluster/index_task.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/base/file.h"
#include "victorious/base/json.h"
#include "victorious/base/one_line.h"

namespace victorious {
namespace {

// Whether an argument of a process can be this text, and JSON hold it.
bool IsArgument(const std::string& text) {
  return ReplaceInvalidUtf8(text) == text && text.find('\0') == std::string::npos;
}

bool IsArgument(const nlohmann::json& value) { return value.is_string() && IsArgument(value.get<std::string>()); }

// Whether these are options of `victorious index` that a task may have, each with its value: none that writes a file,
// and none that a worker gives.
bool AreOptions(std::span<const std::string> options) {
  constexpr std::array<std::string_view, 7> kFlags = {"--models", "--categories", "--params", "--quality",
                                                      "--every",  "--from",       "--to"};
  if (options.size() % 2 != 0) return false;
  for (std::size_t i = 0; i < options.size(); i += 2) {
    if (std::ranges::find(kFlags, options[i]) == kFlags.end() || options[i + 1].starts_with('-')) return false;
  }
  return true;
}

nlohmann::ordered_json PayloadOf(const IndexTask& task) {
  nlohmann::ordered_json payload = {{"video", task.video}, {"options", task.options}, {"program", task.program}};
  if (!task.targets.empty()) payload["targets"] = task.targets;
  if (!task.content_id.empty()) payload["content_id"] = task.content_id;
  for (const ContentFile& file : task.files) {
    payload["files"].push_back({{"path", file.path}, {"content_id", file.content_id}, {"bytes", file.bytes}});
  }
  if (task.segment_s > 0) payload["segment_s"] = task.segment_s;
  if (!task.covers.empty()) payload["covers"] = task.covers;
  if (task.redo_other) payload["redo_other"] = true;
  if (task.part) {
    payload["cut"] = task.part->cut;
    payload["from"] = task.part->frames.from;
    payload["to"] = task.part->frames.to;
  }
  return payload;
}

// A whole number of at least 0.
std::optional<std::int64_t> CountOf(const nlohmann::json& fields, const char* name) {
  if (!fields.contains(name) || !fields[name].is_number_integer()) return std::nullopt;
  const auto value = fields[name].get<std::int64_t>();
  return value >= 0 ? std::optional(value) : std::nullopt;
}

std::optional<SegmentPart> PartOf(const nlohmann::json& fields) {
  const auto cut = CountOf(fields, "cut");
  const auto from = CountOf(fields, "from");
  const auto to = CountOf(fields, "to");
  if (!cut || !from || !to || *from >= *to) return std::nullopt;
  return SegmentPart{*cut, {*from, *to}};
}

std::optional<ContentFile> FileOf(const nlohmann::json& fields) {
  const auto has_text = [&](const char* name) { return fields.contains(name) && IsArgument(fields[name]); };
  if (!fields.is_object() || !has_text("path") || !has_text("content_id")) return std::nullopt;
  ContentFile file{
      .path = fields["path"], .content_id = fields["content_id"], .bytes = CountOf(fields, "bytes").value_or(-1)};
  return IsValid(file) ? std::optional(std::move(file)) : std::nullopt;
}

Expected<std::vector<ContentFile>> FilesOf(const nlohmann::json& json) {
  std::vector<ContentFile> files;
  if (json.is_array()) {
    for (const nlohmann::json& fields : json) {
      if (std::optional<ContentFile> file = FileOf(fields)) files.push_back(*std::move(file));
    }
  }
  if (json.is_array() && files.size() == json.size()) return files;
  return Fail(ErrorCode::kInvalidArgument,
              "files must be a list of absolute paths, each with the hash and the size of its content");
}

Expected<std::map<std::string, std::string>> TargetsOf(const nlohmann::json& json) {
  std::map<std::string, std::string> targets;
  if (json.is_object()) {
    for (const auto& [name, content_id] : json.items()) {
      if (IsArgument(name) && IsArgument(content_id)) targets.emplace(name, content_id.get<std::string>());
    }
  }
  if (json.is_object() && targets.size() == json.size()) return targets;
  return Fail(ErrorCode::kInvalidArgument, "targets must be content ids by name");
}

std::unexpected<Error> ChangedTarget(const std::string& name, std::string_view what) {
  return Fail(
      ErrorCode::kInvalidArgument,
      fmt::format("the model or category {} {} after the video was submitted: put back what was there then, the "
                  "same on all machines, or submit the video again",
                  OneLine(name), what));
}

}  // namespace

std::string TargetsText(const std::map<std::string, std::string>& targets) { return DumpJson(nlohmann::json(targets)); }

Status CheckTargets(std::string_view targets_text, std::span<const ModelRecord> present) {
  VICTORIOUS_ASSIGN_OR_RETURN(const nlohmann::json json, ParseJson(targets_text));
  VICTORIOUS_ASSIGN_OR_RETURN(auto missing, TargetsOf(json));
  for (const ModelRecord& target : present) {
    const auto submitted = missing.find(target.name);
    if (submitted == missing.end()) return ChangedTarget(target.name, "was added");
    if (submitted->second != target.content_id) return ChangedTarget(target.name, "was replaced");
    missing.erase(submitted);
  }
  if (!missing.empty()) return ChangedTarget(missing.begin()->first, "was removed");
  return {};
}

Expected<postgres::NewTask> ToQueue(const IndexTask& task, const std::string& content,
                                    postgres::TaskPriority priority) {
  const auto invalid = [](const std::string& text) {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: not UTF-8: rename it", OneLine(text)));
  };
  if (!IsArgument(task.video)) return invalid(task.video);
  for (const std::string& option : task.options) {
    if (!IsArgument(option)) return invalid(option);
  }
  for (const auto& [name, content_id] : task.targets) {
    if (!IsArgument(name)) return invalid(name);
  }
  for (const ContentFile& file : task.files) {
    if (!IsArgument(file.path)) return invalid(file.path);
  }
  return postgres::NewTask{.kind = std::string(task.is_live ? kLiveTaskKind : kIndexTaskKind),
                           .key = fmt::format("{} {}", content, DumpJson(nlohmann::json(task.options))),
                           .priority = priority,
                           .payload = DumpJson(PayloadOf(task)),
                           .program = task.program,
                           .is_lasting = task.is_live};
}

std::vector<postgres::NewTask> PartsOf(const IndexTask& video, const std::string& key, const VideoCut& cut) {
  std::vector<postgres::NewTask> parts;
  for (const Segment& segment : cut.segments) {
    if (segment.state != SegmentState::kOpen) continue;
    IndexTask part = video;
    part.segment_s = 0;
    part.part = SegmentPart{cut.id, segment.frames};
    parts.push_back({.kind = std::string(kSegmentTaskKind),
                     .key = fmt::format("{} cut {} {} {}", key, cut.id, segment.frames.from, segment.frames.to),
                     .payload = DumpJson(PayloadOf(part)),
                     .program = video.program});
  }
  return parts;
}

Expected<IndexTask> FromQueue(std::string_view kind, std::string_view payload) {
  if (kind != kIndexTaskKind && kind != kSegmentTaskKind && kind != kLiveTaskKind) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("a task of the kind \"{}\", which this program cannot do", OneLine(std::string(kind))));
  }
  const auto invalid = [](std::string_view what) {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("a task that is not valid: {}", what));
  };
  const Expected<nlohmann::json> fields = ParseJson(payload);
  if (!fields) return invalid(fields.error().message);
  const auto is_argument = [&](const char* name) { return fields->contains(name) && IsArgument((*fields)[name]); };
  if (!fields->is_object() || !is_argument("video") || !is_argument("program"))
    return invalid("video and program must be texts without zero bytes");
  constexpr std::string_view kOptionsRule = "options must be a list of texts without zero bytes";
  if (!fields->contains("options") || !(*fields)["options"].is_array()) return invalid(kOptionsRule);
  IndexTask task{.video = (*fields)["video"], .options = {}, .program = (*fields)["program"]};
  for (const nlohmann::json& option : (*fields)["options"]) {
    if (!IsArgument(option)) return invalid(kOptionsRule);
    task.options.push_back(option);
  }
  if (!AreOptions(task.options)) return invalid("options must be those of `victorious submit`");
  if (fields->contains("targets")) {
    Expected<std::map<std::string, std::string>> targets = TargetsOf((*fields)["targets"]);
    if (!targets) return invalid(targets.error().message);
    task.targets = *std::move(targets);
  }
  if (fields->contains("content_id")) {
    if (!is_argument("content_id")) return invalid("content_id must be a text");
    task.content_id = (*fields)["content_id"];
  }
  if (fields->contains("covers")) {
    if (!is_argument("covers")) return invalid("covers must be a text");
    task.covers = (*fields)["covers"];
  }
  if (fields->contains("redo_other")) {
    if (!(*fields)["redo_other"].is_boolean()) return invalid("redo_other must be true or false");
    task.redo_other = (*fields)["redo_other"];
  }
  if (fields->contains("files")) {
    Expected<std::vector<ContentFile>> files = FilesOf((*fields)["files"]);
    if (!files) return invalid(files.error().message);
    task.files = *std::move(files);
  }
  if (fields->contains("segment_s")) {
    const nlohmann::json& seconds = (*fields)["segment_s"];
    if (!seconds.is_number() || !(seconds.get<double>() > 0)) return invalid("segment_s must be a number above 0");
    task.segment_s = seconds;
  }
  task.is_live = kind == kLiveTaskKind;
  if (kind == kSegmentTaskKind) {
    task.part = PartOf(*fields);
    if (!task.part) return invalid("cut, from and to must be the frames of a segment");
  }
  return task;
}

}  // namespace victorious

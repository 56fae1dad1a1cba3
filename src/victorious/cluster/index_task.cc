#include "victorious/cluster/index_task.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/base/json.h"
#include "victorious/base/one_line.h"

namespace victorious {
namespace {

// Whether an argument of a process can be this text, and JSON hold it.
bool IsArgument(const std::string& text) {
  return ReplaceInvalidUtf8(text) == text && text.find('\0') == std::string::npos;
}

bool IsArgument(const nlohmann::json& value) { return value.is_string() && IsArgument(value.get<std::string>()); }

}  // namespace

Expected<postgres::NewTask> ToQueue(const IndexTask& task, const std::string& content,
                                    postgres::TaskPriority priority) {
  const auto invalid = [](const std::string& text) {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: not UTF-8: rename it", OneLine(text)));
  };
  if (!IsArgument(task.video)) return invalid(task.video);
  for (const std::string& option : task.options) {
    if (!IsArgument(option)) return invalid(option);
  }
  const nlohmann::ordered_json payload = {{"video", task.video}, {"options", task.options}, {"program", task.program}};
  return postgres::NewTask{.kind = std::string(kIndexTaskKind),
                           .key = fmt::format("{} {}", content, DumpJson(nlohmann::json(task.options))),
                           .priority = priority,
                           .payload = DumpJson(payload),
                           .program = task.program};
}

Expected<IndexTask> FromQueue(std::string_view kind, std::string_view payload) {
  if (kind != kIndexTaskKind) {
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
  return task;
}

}  // namespace victorious

#include "victorious/cluster/index_task.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/base/json.h"

namespace victorious {
namespace {

// Bytes that are not UTF-8 are replaced.
std::string Dump(const nlohmann::ordered_json& json) {
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace

postgres::NewTask ToQueue(const IndexTask& task, const std::string& content, postgres::TaskPriority priority) {
  const nlohmann::ordered_json payload = {{"video", task.video}, {"options", task.options}, {"program", task.program}};
  return {.kind = std::string(kIndexTaskKind),
          .key = fmt::format("{} {}", content, Dump(task.options)),
          .priority = priority,
          .payload = Dump(payload),
          .program = task.program};
}

Expected<IndexTask> FromQueue(std::string_view kind, std::string_view payload) {
  if (kind != kIndexTaskKind) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("a task of the kind \"{}\", which this program cannot do", kind));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const nlohmann::json fields, ParseJson(payload));
  const auto is_text = [&](const char* name) { return fields.contains(name) && fields[name].is_string(); };
  const auto invalid = [](std::string_view what) {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("a task that is not valid: {}", what));
  };
  if (!fields.is_object() || !is_text("video") || !is_text("program"))
    return invalid("video and program must be texts");
  if (!fields.contains("options") || !fields["options"].is_array()) return invalid("options must be a list of texts");
  IndexTask task{.video = fields["video"], .options = {}, .program = fields["program"]};
  for (const nlohmann::json& option : fields["options"]) {
    if (!option.is_string()) return invalid("options must be a list of texts");
    task.options.push_back(option);
  }
  return task;
}

}  // namespace victorious

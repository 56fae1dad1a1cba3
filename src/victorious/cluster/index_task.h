// One video to be indexed, as a task of the queue.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/store/postgres/task_queue.h"

namespace victorious {

inline constexpr std::string_view kIndexTaskKind = "index";

struct IndexTask {
  std::string video;                 ///< absolute path, the same on all machines
  std::vector<std::string> options;  ///< of `victorious index`, but for --db: "--models", "/data/models", …
  std::string program;               ///< ProgramId() of the program that submitted it: others may find other things
};

/// The task for the queue.
/// @param content  identifies the content of the video, the models and the categories: what was submitted with the same
///                 content and options is one task
/// Error: kInvalidArgument for a text that a task cannot hold: not UTF-8, or with a zero byte.
[[nodiscard]] Expected<postgres::NewTask> ToQueue(const IndexTask& task, const std::string& content,
                                                  postgres::TaskPriority priority);

/// Safe for any bytes. Error: kInvalidArgument, in one line, for a task of another kind, or a payload that is not
/// valid.
[[nodiscard]] Expected<IndexTask> FromQueue(std::string_view kind, std::string_view payload);

}  // namespace victorious

// The program's log: what a person should know beside the result. Lines go to standard error, or to the parent process
// as events; apps/cli/run_program.h decides.
#pragma once

#include <string>
#include <utility>

#include <fmt/format.h>

namespace victorious {

/// Thread-safe, as are the others. The line has no newline; external text in it passes OneLine() (one_line.h).
void LogInfo(const std::string& line);
void LogWarning(const std::string& line);
void LogError(const std::string& line);

template <typename... Values>
void LogInfo(fmt::format_string<Values...> format, Values&&... values) {
  LogInfo(fmt::format(format, std::forward<Values>(values)...));
}

template <typename... Values>
void LogWarning(fmt::format_string<Values...> format, Values&&... values) {
  LogWarning(fmt::format(format, std::forward<Values>(values)...));
}

}  // namespace victorious

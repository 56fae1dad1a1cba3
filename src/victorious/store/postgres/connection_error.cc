#include "victorious/store/postgres/connection_error.h"

#include <algorithm>

#include <fmt/format.h>

namespace victorious::postgres {

std::string CollapseBlanks(std::string_view text) {
  std::string line;
  for (const char c : text) {
    const bool is_space = c == '\n' || c == '\r' || c == '\t' || c == ' ';
    if (!is_space) line += c;
    if (is_space && !line.empty() && line.back() != ' ') line += ' ';
  }
  while (line.ends_with(' ')) line.pop_back();
  return line;
}

std::string FirstLine(std::string_view text) { return CollapseBlanks(text.substr(0, text.find('\n'))); }

// "…: FATAL:  3D000: database "x" does not exist", with two blanks before the code.
ConnectionFailure ParseConnectionFailure(std::string_view message) {
  constexpr std::string_view kBefore = ":  ";
  constexpr std::string_view kAfter = ": ";
  constexpr std::size_t kDigits = 5;
  const std::string_view line = message.substr(0, message.find('\n'));
  for (std::size_t at = line.find(kBefore); at != line.npos; at = line.find(kBefore, at + 1)) {
    const std::string_view state = line.substr(at + kBefore.size(), kDigits);
    const std::string_view rest = line.substr(std::min(line.size(), at + kBefore.size() + kDigits));
    const bool is_state = state.size() == kDigits && std::ranges::all_of(state, [](char c) {
                            return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z');
                          });
    if (!is_state || !rest.starts_with(kAfter)) continue;
    return {.sqlstate = std::string(state),
            .text = CollapseBlanks(fmt::format("{}{}", line.substr(0, at + 1), rest.substr(1)))};
  }
  return {.sqlstate = {}, .text = CollapseBlanks(line)};
}

Error ErrorFromFailure(const std::string& name, const ConnectionFailure& failure) {
  const std::string& state = failure.sqlstate;
  const auto error = [&](ErrorCode code, std::string_view remedy) {
    return Error{code, fmt::format("{}: {}: {}", name, failure.text, remedy)};
  };
  if (state == "57P03") return error(ErrorCode::kUnavailable, "the server is starting or stopping: try again");
  if (state.starts_with("53")) {
    return error(ErrorCode::kUnavailable, "raise the server's max_connections, four for each worker, or run fewer");
  }
  if (state == "3D000") return error(ErrorCode::kNotFound, "create it (createdb -E UTF8), or correct its name");
  if (state == "42501") return error(ErrorCode::kPermissionDenied, "grant CONNECT on the database to the role");
  if (state.starts_with("22") || state == "42704") {
    return error(ErrorCode::kInvalidArgument, "correct the parameters of the URL");
  }
  if (state.empty()) {
    return error(ErrorCode::kPermissionDenied,
                 "give the password (PGPASSWORD or ~/.pgpass), or correct how the connection is encrypted (sslmode)");
  }
  return error(ErrorCode::kPermissionDenied, "correct the role and its password (PGPASSWORD or ~/.pgpass)");
}

}  // namespace victorious::postgres

// Errors as values. Every function that can fail on what it is given returns Expected<T> or Status; a programmer's
// mistake is a VICTORIOUS_CHECK (check.h). Third-party exceptions stop at the module that calls them.
#pragma once

#include <expected>
#include <string>
#include <string_view>
#include <utility>

namespace victorious {

/// The closed set of reasons. One table (ExitStatus) maps them to the program's exit status.
enum class ErrorCode {
  kInvalidArgument,   ///< a value, flag, file or parameter that cannot be used: the caller must change it
  kNotFound,          ///< the named thing does not exist
  kAlreadyExists,     ///< the name is taken
  kDataLoss,          ///< outside bytes that are corrupt, cut off or of another program
  kUnsupported,       ///< well formed, but of a kind or a version this program does not read
  kPermissionDenied,  ///< a read-only folder or file
  kNoSpace,           ///< a full disk
  kConflict,          ///< another process is at the same work: try again later
  kCancelled,         ///< the user stopped it
  kInternal,          ///< a library or the system failed in a way that input does not explain
};

/// What went wrong. `message` is one line: what, where, and what would be right.
struct Error {
  ErrorCode code = ErrorCode::kInternal;
  std::string message;

  /// The same error with `context` put in front ("context: message"), added on the way up.
  [[nodiscard]] Error WithContext(std::string_view context) && {
    message.insert(0, ": ").insert(0, context);
    return std::move(*this);
  }

  bool operator==(const Error&) const = default;
};

template <typename T>
using Expected = std::expected<T, Error>;
using Status = std::expected<void, Error>;

/// Shorthand for `return Fail(ErrorCode::kNotFound, "...")`.
[[nodiscard]] inline std::unexpected<Error> Fail(ErrorCode code, std::string message) {
  return std::unexpected(Error{code, std::move(message)});
}

/// The error of a failed system call, with `errno` turned into the nearest code: a full disk, a read-only folder, …
/// @param what  what was tried and on which path, e.g. "write models/box.vmodel"
[[nodiscard]] Error ErrorFromErrno(int errno_value, std::string_view what);

/// The program's exit status for an error: 2 for bad usage and bad input, 1 for anything else.
[[nodiscard]] int ExitStatus(ErrorCode code);

/// The code's name in snake case, as logs and JSON show it.
[[nodiscard]] std::string_view Name(ErrorCode code);

}  // namespace victorious

#define VICTORIOUS_CONCAT_INNER(a, b) a##b
#define VICTORIOUS_CONCAT(a, b) VICTORIOUS_CONCAT_INNER(a, b)

/// Returns the error of `expression` (a Status or Expected) to the caller, if it has one.
#define VICTORIOUS_RETURN_IF_ERROR(expression)                       \
  do {                                                               \
    if (auto victorious_status = (expression); !victorious_status) { \
      return std::unexpected(std::move(victorious_status).error());  \
    }                                                                \
  } while (false)

/// `VICTORIOUS_ASSIGN_OR_RETURN(const auto value, Compute());`
// NOLINTBEGIN(bugprone-macro-parentheses): a declaration cannot stand in parentheses
#define VICTORIOUS_ASSIGN_OR_RETURN(declaration, expression) \
  VICTORIOUS_ASSIGN_OR_RETURN_INNER(VICTORIOUS_CONCAT(victorious_result_, __LINE__), declaration, expression)
#define VICTORIOUS_ASSIGN_OR_RETURN_INNER(result, declaration, expression) \
  auto result = (expression);                                              \
  if (!result) return std::unexpected(std::move(result).error());          \
  declaration = *std::move(result)
// NOLINTEND(bugprone-macro-parentheses)

// Errors as values. Every function that can fail on its input returns Expected<T> or Status; programming errors are
// VICTORIOUS_CHECK (check.h). Third-party exceptions are caught in the module that calls the library.
#pragma once

#include <array>
#include <expected>
#include <string>
#include <string_view>
#include <utility>

#include "victorious/base/enum_text.h"

namespace victorious {

/// The closed set of error reasons. ExitStatus maps them to the program's exit status.
enum class ErrorCode {
  kInvalidArgument,   ///< an unusable value, flag, file or parameter: the caller must change it
  kNotFound,          ///< the named item does not exist
  kAlreadyExists,     ///< the name is taken
  kDataLoss,          ///< external data that is corrupt, truncated or of another program
  kUnsupported,       ///< well-formed, but of a kind or version that this program does not read
  kPermissionDenied,  ///< a read-only folder or file
  kNoSpace,           ///< a full disk
  kConflict,          ///< another process does the same work: try again later
  kCancelled,         ///< the user cancelled the operation
  kInternal,          ///< a library or the system failed for a reason that the input does not explain
  kUnavailable,       ///< what is needed, as a database, does not answer or is locked by others: try again later
};

/// The codes' names in logs, events and JSON. Every code has one.
inline constexpr auto kErrorCodeTexts =
    std::to_array<EnumText<ErrorCode>>({{ErrorCode::kInvalidArgument, "invalid_argument"},
                                        {ErrorCode::kNotFound, "not_found"},
                                        {ErrorCode::kAlreadyExists, "already_exists"},
                                        {ErrorCode::kDataLoss, "data_loss"},
                                        {ErrorCode::kUnsupported, "unsupported"},
                                        {ErrorCode::kPermissionDenied, "permission_denied"},
                                        {ErrorCode::kNoSpace, "no_space"},
                                        {ErrorCode::kConflict, "conflict"},
                                        {ErrorCode::kCancelled, "cancelled"},
                                        {ErrorCode::kInternal, "internal"},
                                        {ErrorCode::kUnavailable, "unavailable"}});

/// An error. `message` is one line: what is wrong, where, and what would be right.
struct Error {
  ErrorCode code = ErrorCode::kInternal;
  std::string message;

  /// Returns the error with `context` prepended ("context: message"). Callers use it while passing the error up.
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

/// Returns the error of a failed system call, with the error code that matches `errno_value` (full disk, read-only
/// folder, …).
/// @param what  the operation and its path, e.g. "write models/box.vmodel"
[[nodiscard]] Error ErrorFromErrno(int errno_value, std::string_view what);

/// Returns the program's exit status for an error: 2 for bad usage and bad input, 1 otherwise.
[[nodiscard]] int ExitStatus(ErrorCode code);

/// Returns the code's name (kErrorCodeTexts).
[[nodiscard]] constexpr std::string_view Name(ErrorCode code) { return ToText(kErrorCodeTexts, code); }

}  // namespace victorious

#define VICTORIOUS_CONCAT_INNER(a, b) a##b
#define VICTORIOUS_CONCAT(a, b) VICTORIOUS_CONCAT_INNER(a, b)

/// Returns from the calling function with the error of `expression` (a Status or Expected), if it has one.
#define VICTORIOUS_RETURN_IF_ERROR(expression)                       \
  do {                                                               \
    if (auto victorious_status = (expression); !victorious_status) { \
      return std::unexpected(std::move(victorious_status).error());  \
    }                                                                \
  } while (false)

/// Declares a variable with the value of an Expected, or returns its error from the calling function:
/// `VICTORIOUS_ASSIGN_OR_RETURN(const auto value, Compute());`
// NOLINTBEGIN(bugprone-macro-parentheses): a declaration cannot be parenthesised
#define VICTORIOUS_ASSIGN_OR_RETURN(declaration, expression) \
  VICTORIOUS_ASSIGN_OR_RETURN_INNER(VICTORIOUS_CONCAT(victorious_result_, __LINE__), declaration, expression)
#define VICTORIOUS_ASSIGN_OR_RETURN_INNER(result, declaration, expression) \
  auto result = (expression);                                              \
  if (!result) return std::unexpected(std::move(result).error());          \
  declaration = *std::move(result)
// NOLINTEND(bugprone-macro-parentheses)

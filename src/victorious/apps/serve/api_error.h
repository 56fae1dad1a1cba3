// Errors of the API: an Error, the parameter or field that it is about, and its HTTP status.
#pragma once

#include <expected>
#include <string>
#include <utility>

#include "victorious/apps/serve/http_message.h"
#include "victorious/base/error.h"

namespace victorious {

struct ApiError {
  Error error;
  std::string field;  ///< the query parameter or member of the body; empty: none in particular

  ApiError(Error e, std::string of = "") : error(std::move(e)), field(std::move(of)) {}  // NOLINT: converts
};

template <typename T>
using ApiExpected = std::expected<T, ApiError>;
using ApiStatus = std::expected<void, ApiError>;

/// Shorthand for a kInvalidArgument about `field`.
[[nodiscard]] inline std::unexpected<ApiError> FailField(std::string field, std::string message) {
  return std::unexpected(ApiError(Error{ErrorCode::kInvalidArgument, std::move(message)}, std::move(field)));
}

/// After how many seconds a client asks again for what the server could not do now.
inline constexpr const char* kRetryAfter_s = "3";

/// The HTTP status of an error.
[[nodiscard]] int HttpStatus(ErrorCode code);

/// The response {"code": …, "message": …, "field": …} with this status; `field` is null if empty.
[[nodiscard]] HttpResponse ErrorResponse(int status, std::string_view code, std::string_view message,
                                         std::string_view field = "");
[[nodiscard]] HttpResponse ErrorResponse(const ApiError& error);

}  // namespace victorious

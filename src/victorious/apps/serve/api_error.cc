#include "victorious/apps/serve/api_error.h"

#include <nlohmann/json.hpp>

#include "victorious/base/json.h"
#include "victorious/types/json_values.h"

namespace victorious {

int HttpStatus(ErrorCode code) {
  switch (code) {
    case ErrorCode::kInvalidArgument:
      return 400;
    case ErrorCode::kPermissionDenied:
      return 403;
    case ErrorCode::kNotFound:
      return 404;
    case ErrorCode::kAlreadyExists:
    case ErrorCode::kConflict:
      return 409;
    case ErrorCode::kUnsupported:
      return 415;
    case ErrorCode::kDataLoss:
      return 422;
    case ErrorCode::kCancelled:
    case ErrorCode::kUnavailable:
      return 503;
    case ErrorCode::kNoSpace:
      return 507;
    case ErrorCode::kInternal:
      break;
  }
  return 500;
}

HttpResponse ErrorResponse(int status, std::string_view code, std::string_view message, std::string_view field) {
  const Json body = {{"code", code}, {"message", message}, {"field", field.empty() ? Json() : Json(field)}};
  return {.status = status,
          .content_type = "application/json",
          .headers = {{"Cache-Control", "no-store"}},
          .body = DumpJson(body) + "\n",
          .file = {}};
}

HttpResponse ErrorResponse(const ApiError& error) {
  return ErrorResponse(HttpStatus(error.error.code), Name(error.error.code), error.error.message, error.field);
}

}  // namespace victorious

#include "victorious/apps/serve/api_response.h"

#include <span>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/apps/serve/byte_range.h"
#include "victorious/base/file.h"
#include "victorious/base/json.h"

namespace victorious {

HttpResponse JsonResponse(const Json& json) { return JsonTextResponse(DumpJson(json) + "\n"); }

HttpResponse JsonTextResponse(std::string text) {
  return {.content_type = "application/json",
          .headers = {{"Cache-Control", "no-store"}},
          .body = std::move(text),
          .file = {}};
}

std::unexpected<ApiError> NotFound(std::string message) {
  return std::unexpected(ApiError(Error{ErrorCode::kNotFound, std::move(message)}));
}

HttpResponse TaggedResponse(const HttpRequest& request, std::string_view content_type, std::string bytes,
                            int max_age_s) {
  const std::string etag = fmt::format("\"{:016x}\"", Checksum(std::as_bytes(std::span(bytes))));
  HttpResponse response{.content_type = std::string(content_type),
                        .headers = {{"ETag", etag}, {"Cache-Control", fmt::format("private, max-age={}", max_age_s)}},
                        .body = {},
                        .file = {}};
  if (MatchesEtag(request.if_none_match, etag)) {
    response.status = 304;
    response.content_type.clear();
  } else {
    response.body = std::move(bytes);
  }
  return response;
}

}  // namespace victorious

// The kinds of successful responses that the routes give.
#pragma once

#include <string>

#include "victorious/apps/serve/api_error.h"
#include "victorious/apps/serve/http_message.h"
#include "victorious/types/json_values.h"

namespace victorious {

[[nodiscard]] HttpResponse JsonResponse(const Json& json);
/// @param text  JSON
[[nodiscard]] HttpResponse JsonTextResponse(std::string text);

[[nodiscard]] std::unexpected<ApiError> NotFound(std::string message);

/// Bytes under a tag of their content, so that a browser asks again without receiving them again.
/// @param max_age_s  for which the browser does not ask
[[nodiscard]] HttpResponse TaggedResponse(const HttpRequest& request, std::string_view content_type, std::string bytes,
                                          int max_age_s);

}  // namespace victorious

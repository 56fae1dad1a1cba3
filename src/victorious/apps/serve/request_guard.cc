#include "victorious/apps/serve/request_guard.h"

#include <algorithm>
#include <array>
#include <string>

#include <fmt/format.h>

#include "victorious/apps/serve/api_error.h"
#include "victorious/base/text.h"

namespace victorious {
namespace {

constexpr std::array<std::string_view, 3> kLoopbackNames = {"127.0.0.1", "localhost", "[::1]"};

bool IsOwnHost(std::string_view host, int port) {
  return std::ranges::any_of(kLoopbackNames, [&](std::string_view name) {
    return host == fmt::format("{}:{}", name, port) || (port == 80 && host == name);
  });
}

// A page fetches from its own server only, and map tiles from `tile_origin`.
std::string ContentSecurityPolicy(const std::string& tile_origin) {
  const std::string tiles = tile_origin.empty() ? "" : " " + tile_origin;
  return "default-src 'self'; connect-src 'self'" + tiles + "; img-src 'self' data: blob:" + tiles +
         "; media-src 'self' blob:; worker-src 'self' blob:; style-src 'self' 'unsafe-inline'; object-src 'none'; "
         "base-uri 'none'; frame-ancestors 'none'";
}

}  // namespace

std::optional<HttpResponse> RefuseForeign(const HttpRequest& request, bool is_of_api, const ServerIdentity& server,
                                          int port) {
  const std::string_view scheme = server.has_tls ? "https://" : "http://";
  const std::string host = LowerCase(request.host);
  if (server.is_loopback && !IsOwnHost(host, port)) {
    return ErrorResponse(
        421, "foreign_host",
        fmt::format("this server answers to {}127.0.0.1:{} only, not to the host \"{}\"", scheme, port, request.host));
  }
  const std::string_view origin = request.origin;
  const std::string_view origin_host = origin.substr(std::min(scheme.size(), origin.size()));
  const bool is_own = origin.starts_with(scheme) &&
                      (server.is_loopback ? IsOwnHost(origin_host, port) : !host.empty() && origin_host == host);
  if (!origin.empty() && !is_own) {
    return ErrorResponse(403, "foreign_origin", "pages of other sites may not use this server");
  }
  if (request.fetch_site == "cross-site" && is_of_api) {
    return ErrorResponse(403, "foreign_origin", "pages of other sites may not use this server");
  }
  // Types that a form of another site cannot send.
  const bool has_body = request.method == HttpMethod::kPut || request.method == HttpMethod::kPost;
  const bool is_upload = request.method == HttpMethod::kPost && request.content_type == "application/octet-stream";
  if (has_body && !is_upload && !request.content_type.starts_with("application/json")) {
    return ErrorResponse(415, "unsupported", "the body must have the content type application/json", "Content-Type");
  }
  return std::nullopt;
}

HeaderList SecurityHeaders(const std::string& tile_origin, bool has_tls) {
  HeaderList headers = {{"X-Content-Type-Options", "nosniff"},
                        {"Referrer-Policy", "no-referrer"},
                        {"Cross-Origin-Resource-Policy", "same-origin"},
                        {"Content-Security-Policy", ContentSecurityPolicy(tile_origin)}};
  if (has_tls) headers.emplace_back("Strict-Transport-Security", "max-age=31536000");
  return headers;
}

}  // namespace victorious

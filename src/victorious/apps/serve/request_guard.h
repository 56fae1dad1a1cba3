// Refuses requests that a page of another site sends through the user's browser. A server on the loopback address is
// reached by every page that the browser shows: directly, and by a name that its owner points to 127.0.0.1 (DNS
// rebinding). The browser's headers tell them apart.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "victorious/apps/serve/http_message.h"

namespace victorious {

/// How a server is reached.
struct ServerIdentity {
  bool is_loopback = true;  ///< from this machine only
  bool has_tls = false;
};

/// Returns the refusal of a request, or std::nullopt. Host must be 127.0.0.1, localhost or [::1] with this port (421);
/// Origin, if sent, the same server, and a request for the API must not come from another site (403); a request with a
/// body must be JSON (415). A server that other machines reach has any name: there, an account is needed, and its
/// cookie goes to its own name only.
/// @param is_of_api  the decoded target is one of the API, or cannot be decoded
[[nodiscard]] std::optional<HttpResponse> RefuseForeign(const HttpRequest& request, bool is_of_api,
                                                        const ServerIdentity& server, int port);

using HeaderList = std::vector<std::pair<std::string, std::string>>;

/// What browsers are told with every response: no content type by guess, no frame, nothing from elsewhere; with TLS,
/// that it is to be used from now on.
/// @param tile_origin  where map tiles may come from, too, as in https://tile.example.org; empty: nowhere
[[nodiscard]] HeaderList SecurityHeaders(const std::string& tile_origin, bool has_tls);

}  // namespace victorious

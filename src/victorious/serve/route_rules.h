// The routes of the API and who may use them: one table, which Api::Handle asks before anything else. A request that it
// does not have is refused.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "victorious/serve/http_message.h"
#include "victorious/store/account_store.h"

namespace victorious {

struct RouteRule {
  HttpMethod method = HttpMethod::kGet;  ///< kGet answers HEAD, too
  std::string_view path;                 ///< as in api/openapi.json; {…} stands for one segment
  std::optional<Role> least;             ///< that an account needs; std::nullopt: open to everybody
};

[[nodiscard]] std::span<const RouteRule> RouteRules();

/// The rule of a request; nullptr: there is none.
[[nodiscard]] const RouteRule* FindRule(HttpMethod method, std::span<const std::string> segments);

/// The methods of an address, as the header Allow names them; empty: there is no such address.
[[nodiscard]] std::string AllowedMethods(std::span<const std::string> segments);

}  // namespace victorious

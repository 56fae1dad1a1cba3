#include "victorious/apps/serve/route_table.h"

namespace victorious {
namespace {

// The segments in the places of {…}; std::nullopt for another address.
std::optional<std::vector<std::string>> MatchPath(std::string_view path, std::span<const std::string> segments) {
  std::vector<std::string> parameters;
  for (const std::string& segment : segments) {
    if (!path.starts_with('/')) return std::nullopt;
    path.remove_prefix(1);
    const std::string_view part = path.substr(0, path.find('/'));
    if (part.starts_with('{')) {
      parameters.push_back(segment);
    } else if (part != segment) {
      return std::nullopt;
    }
    path.remove_prefix(part.size());
  }
  return path.empty() ? std::optional(std::move(parameters)) : std::nullopt;
}

}  // namespace

std::optional<RouteTable::Match> RouteTable::Find(HttpMethod method, Segments segments) const {
  const HttpMethod asked = method == HttpMethod::kHead ? HttpMethod::kGet : method;
  for (const ApiRoute& route : routes_) {
    if (route.method != asked) continue;
    if (auto parameters = MatchPath(route.path, segments)) return Match{&route, *std::move(parameters)};
  }
  return std::nullopt;
}

std::string RouteTable::AllowedMethods(Segments segments) const {
  std::string methods;
  const auto add = [&](HttpMethod method, std::string_view name) {
    if (!Find(method, segments)) return;
    if (!methods.empty()) methods += ", ";
    methods += name;
  };
  add(HttpMethod::kGet, "GET, HEAD");
  add(HttpMethod::kPut, "PUT");
  add(HttpMethod::kPost, "POST");
  add(HttpMethod::kDelete, "DELETE");
  return methods;
}

}  // namespace victorious

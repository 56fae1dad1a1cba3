#include "victorious/serve/route_rules.h"

#include <algorithm>
#include <array>

namespace victorious {
namespace {

constexpr auto kRules = std::to_array<RouteRule>({
    {HttpMethod::kGet, "/api/v1/session", std::nullopt},
    {HttpMethod::kPost, "/api/v1/session", std::nullopt},
    {HttpMethod::kPost, "/api/v1/session/end", std::nullopt},
    {HttpMethod::kGet, "/api/v1/project", Role::kViewer},
    {HttpMethod::kGet, "/api/v1/videos", Role::kViewer},
    {HttpMethod::kGet, "/api/v1/videos/{id}", Role::kViewer},
    {HttpMethod::kGet, "/api/v1/videos/{id}/times", Role::kViewer},
    {HttpMethod::kGet, "/api/v1/videos/{id}/sightings", Role::kViewer},
    {HttpMethod::kGet, "/api/v1/videos/{id}/camera", Role::kViewer},
    {HttpMethod::kGet, "/api/v1/videos/{id}/file", Role::kViewer},
    {HttpMethod::kGet, "/api/v1/videos/{id}/copy", Role::kViewer},
    {HttpMethod::kGet, "/api/v1/videos/{id}/frames/{frame}", Role::kViewer},
    {HttpMethod::kGet, "/api/v1/objects", Role::kViewer},
    {HttpMethod::kGet, "/api/v1/objects/counts", Role::kViewer},
    {HttpMethod::kGet, "/api/v1/tiles/{z}/{x}/{y}", Role::kViewer},
    {HttpMethod::kGet, "/api/v1/objects/{id}", Role::kViewer},
    {HttpMethod::kGet, "/api/v1/objects/{id}/sightings", Role::kViewer},
    {HttpMethod::kGet, "/api/v1/objects/{id}/thumbnail", Role::kViewer},
    {HttpMethod::kPut, "/api/v1/objects/{id}/review", Role::kAnalyst},
    {HttpMethod::kPost, "/api/v1/uploads", Role::kAnalyst},
    {HttpMethod::kGet, "/api/v1/jobs", Role::kViewer},
    {HttpMethod::kPost, "/api/v1/jobs", Role::kAnalyst},
    {HttpMethod::kPost, "/api/v1/jobs/{id}/cancel", Role::kAnalyst},
    {HttpMethod::kGet, "/api/v1/jobs/{id}/files/{name}", Role::kViewer},
    {HttpMethod::kGet, "/api/v1/events", Role::kViewer},
    {HttpMethod::kGet, "/api/v1/models/{id}/views/{view}", Role::kViewer},
    {HttpMethod::kGet, "/api/v1/audit", Role::kAdmin},
});

bool IsAt(std::string_view path, std::span<const std::string> segments) {
  for (const std::string& segment : segments) {
    if (!path.starts_with('/')) return false;
    path.remove_prefix(1);
    const std::string_view part = path.substr(0, path.find('/'));
    if (!part.starts_with('{') && part != segment) return false;
    path.remove_prefix(part.size());
  }
  return path.empty();
}

}  // namespace

std::span<const RouteRule> RouteRules() { return kRules; }

const RouteRule* FindRule(HttpMethod method, std::span<const std::string> segments) {
  const HttpMethod asked = method == HttpMethod::kHead ? HttpMethod::kGet : method;
  const auto* const rule = std::ranges::find_if(
      kRules, [&](const RouteRule& one) { return one.method == asked && IsAt(one.path, segments); });
  return rule == kRules.end() ? nullptr : rule;
}

std::string AllowedMethods(std::span<const std::string> segments) {
  std::string methods;
  const auto add = [&](HttpMethod method, std::string_view name) {
    if (FindRule(method, segments) == nullptr) return;
    if (!methods.empty()) methods += ", ";
    methods += name;
  };
  add(HttpMethod::kGet, "GET, HEAD");
  add(HttpMethod::kPut, "PUT");
  add(HttpMethod::kPost, "POST");
  return methods;
}

}  // namespace victorious

// The table of routes, and which of them a request is for.
#include <array>

#include "victorious/serve/api.h"

namespace victorious {
namespace {

constexpr bool kHasQuery = true;
constexpr bool kIsSlow = true;

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

// The first that fits is taken: a name stands before a {…} in its place.
std::span<const Api::Route> Api::Routes() {
  static constexpr auto kRoutes = std::to_array<Route>({
      {HttpMethod::kGet, "/api/v1/session", std::nullopt, &Api::Session},
      {HttpMethod::kPost, "/api/v1/session", std::nullopt, &Api::LogIn},
      {HttpMethod::kPost, "/api/v1/session/end", std::nullopt, &Api::LogOut},
      {HttpMethod::kGet, "/api/v1/project", Role::kViewer, &Api::Project},
      {HttpMethod::kGet, "/api/v1/base_map", Role::kViewer, &Api::BaseMapFile},
      {HttpMethod::kGet, "/api/v1/videos", Role::kViewer, &Api::Videos, kHasQuery},
      {HttpMethod::kGet, "/api/v1/videos/{id}", Role::kViewer, &Api::Video},
      {HttpMethod::kGet, "/api/v1/videos/{id}/times", Role::kViewer, &Api::VideoTimes, !kHasQuery, kIsSlow},
      {HttpMethod::kGet, "/api/v1/videos/{id}/sightings", Role::kViewer, &Api::VideoSightings, kHasQuery},
      {HttpMethod::kGet, "/api/v1/videos/{id}/camera", Role::kViewer, &Api::VideoCamera, !kHasQuery, kIsSlow},
      {HttpMethod::kGet, "/api/v1/videos/{id}/file", Role::kViewer, &Api::VideoFile},
      {HttpMethod::kGet, "/api/v1/videos/{id}/copy", Role::kViewer, &Api::VideoCopy},
      {HttpMethod::kGet, "/api/v1/videos/{id}/frames/{frame}", Role::kViewer, &Api::VideoFrame, !kHasQuery, kIsSlow},
      {HttpMethod::kGet, "/api/v1/objects", Role::kViewer, &Api::Objects, kHasQuery},
      {HttpMethod::kGet, "/api/v1/objects/counts", Role::kViewer, &Api::Counts, kHasQuery},
      {HttpMethod::kGet, "/api/v1/tiles/{z}/{x}/{y}", Role::kViewer, &Api::Tile, kHasQuery},
      {HttpMethod::kGet, "/api/v1/objects/{id}", Role::kViewer, &Api::Object},
      {HttpMethod::kGet, "/api/v1/objects/{id}/sightings", Role::kViewer, &Api::ObjectSightings, kHasQuery},
      {HttpMethod::kGet, "/api/v1/objects/{id}/thumbnail", Role::kViewer, &Api::Thumbnail, kHasQuery, kIsSlow},
      {HttpMethod::kGet, "/api/v1/objects/{id}/evidence", Role::kViewer, &Api::Evidence, kHasQuery, kIsSlow},
      {HttpMethod::kGet, "/api/v1/objects/{id}/decisions", Role::kViewer, &Api::Decisions},
      {HttpMethod::kPut, "/api/v1/objects/{id}/review", Role::kAnalyst, &Api::PutReview},
      {HttpMethod::kPost, "/api/v1/uploads", Role::kAnalyst, &Api::Upload, kHasQuery},
      {HttpMethod::kGet, "/api/v1/cluster", Role::kViewer, &Api::Cluster},
      {HttpMethod::kGet, "/api/v1/jobs", Role::kViewer, &Api::Jobs},
      {HttpMethod::kPost, "/api/v1/jobs", Role::kAnalyst, &Api::SubmitJob, !kHasQuery, kIsSlow},
      {HttpMethod::kPost, "/api/v1/jobs/{id}/cancel", Role::kAnalyst, &Api::CancelJob},
      {HttpMethod::kPost, "/api/v1/jobs/{id}/retry", Role::kAnalyst, &Api::RetryJob},
      {HttpMethod::kDelete, "/api/v1/jobs/{id}", Role::kAnalyst, &Api::RemoveJob},
      {HttpMethod::kGet, "/api/v1/jobs/{id}/files/{name}", Role::kViewer, &Api::JobFile},
      {HttpMethod::kGet, "/api/v1/events", Role::kViewer, &Api::Events},
      {HttpMethod::kGet, "/api/v1/thresholds", Role::kViewer, &Api::Thresholds},
      {HttpMethod::kPut, "/api/v1/models/{id}/threshold", Role::kAnalyst, &Api::PutThreshold},
      {HttpMethod::kGet, "/api/v1/models/{id}/views", Role::kViewer, &Api::ModelViews},
      {HttpMethod::kGet, "/api/v1/models/{id}/views/{view}", Role::kViewer, &Api::ViewImage, kHasQuery},
      {HttpMethod::kGet, "/api/v1/audit", Role::kAdmin, &Api::Audit, kHasQuery},
  });
  return kRoutes;
}

std::optional<Api::RouteMatch> Api::FindRoute(HttpMethod method, Segments segments) {
  const HttpMethod asked = method == HttpMethod::kHead ? HttpMethod::kGet : method;
  for (const Route& route : Routes()) {
    if (route.method != asked) continue;
    if (auto parameters = MatchPath(route.path, segments)) return RouteMatch{&route, *std::move(parameters)};
  }
  return std::nullopt;
}

std::string Api::AllowedMethods(Segments segments) {
  std::string methods;
  const auto add = [&](HttpMethod method, std::string_view name) {
    if (!FindRoute(method, segments)) return;
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

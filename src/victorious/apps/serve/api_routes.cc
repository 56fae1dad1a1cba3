#include "victorious/apps/serve/api_routes.h"

#include <utility>

namespace victorious {
namespace {

constexpr bool kHasQuery = true;
constexpr bool kIsSlow = true;
constexpr bool kIsUpload = true;
constexpr bool kIsProbe = true;

template <typename Part>
ApiHandler Of(Part& part, ApiExpected<HttpResponse> (Part::*handler)(const ApiCall& call)) {
  return [&part, handler](const ApiCall& call) { return (part.*handler)(call); };
}

}  // namespace

RouteParts::RouteParts(const SharedByRoutes& shared, std::unique_ptr<ThresholdStore> store)
    : session(shared.access),
      inputs(shared.options, shared.index, shared.videos, shared.copies, shared.uploads),
      project(shared.options, shared.index, shared.live, inputs),
      videos(shared.index, shared.videos, shared.copies),
      objects(shared.index, shared.videos),
      evidence(shared.index, shared.videos, shared.options.models),
      jobs({.options = shared.options,
            .index = shared.index,
            .access = shared.access,
            .live = shared.live,
            .inputs = inputs,
            .copies = shared.copies,
            .uploads = shared.uploads}),
      cluster(shared.options.index),
      operation(shared.access, shared.live, cluster, shared.metrics),
      thresholds(shared.index, std::move(store)) {}

// The first that fits is taken: a name stands before a {…} in its place.
std::vector<ApiRoute> MakeRoutes(RouteParts& parts) {
  return {
      {HttpMethod::kGet, "/api/v1/session", std::nullopt, Of(parts.session, &SessionRoutes::Get)},
      {HttpMethod::kPost, "/api/v1/session", std::nullopt, Of(parts.session, &SessionRoutes::LogIn)},
      {HttpMethod::kPost, "/api/v1/session/end", std::nullopt, Of(parts.session, &SessionRoutes::LogOut)},
      {HttpMethod::kGet, "/api/v1/project", Role::kViewer, Of(parts.project, &ProjectRoutes::Get)},
      {HttpMethod::kGet, "/api/v1/base_map", Role::kViewer, Of(parts.project, &ProjectRoutes::BaseMapFile)},
      {HttpMethod::kGet, "/api/v1/videos", Role::kViewer, Of(parts.videos, &VideoRoutes::List), kHasQuery},
      {HttpMethod::kGet, "/api/v1/videos/{id}", Role::kViewer, Of(parts.videos, &VideoRoutes::Get)},
      {HttpMethod::kGet, "/api/v1/videos/{id}/times", Role::kViewer, Of(parts.videos, &VideoRoutes::Times), !kHasQuery,
       kIsSlow},
      {HttpMethod::kGet, "/api/v1/videos/{id}/sightings", Role::kViewer, Of(parts.videos, &VideoRoutes::Sightings),
       kHasQuery},
      {HttpMethod::kGet, "/api/v1/videos/{id}/camera", Role::kViewer, Of(parts.videos, &VideoRoutes::Camera),
       !kHasQuery, kIsSlow},
      {HttpMethod::kGet, "/api/v1/videos/{id}/file", Role::kViewer, Of(parts.videos, &VideoRoutes::File)},
      {HttpMethod::kGet, "/api/v1/videos/{id}/copy", Role::kViewer, Of(parts.videos, &VideoRoutes::Copy)},
      {HttpMethod::kGet, "/api/v1/videos/{id}/frames/{frame}", Role::kViewer, Of(parts.videos, &VideoRoutes::Frame),
       !kHasQuery, kIsSlow},
      {HttpMethod::kGet, "/api/v1/objects", Role::kViewer, Of(parts.objects, &ObjectRoutes::List), kHasQuery},
      {HttpMethod::kGet, "/api/v1/objects/counts", Role::kViewer, Of(parts.objects, &ObjectRoutes::Counts), kHasQuery},
      {HttpMethod::kGet, "/api/v1/objects/geopackage", Role::kViewer, Of(parts.objects, &ObjectRoutes::Package),
       kHasQuery, kIsSlow},
      {HttpMethod::kGet, "/api/v1/tiles/{z}/{x}/{y}", Role::kViewer, Of(parts.objects, &ObjectRoutes::Tile), kHasQuery},
      {HttpMethod::kGet, "/api/v1/objects/{id}", Role::kViewer, Of(parts.objects, &ObjectRoutes::Get)},
      {HttpMethod::kGet, "/api/v1/objects/{id}/sightings", Role::kViewer, Of(parts.objects, &ObjectRoutes::Sightings),
       kHasQuery},
      {HttpMethod::kGet, "/api/v1/objects/{id}/thumbnail", Role::kViewer, Of(parts.objects, &ObjectRoutes::Thumbnail),
       kHasQuery, kIsSlow},
      {HttpMethod::kGet, "/api/v1/objects/{id}/evidence", Role::kViewer, Of(parts.evidence, &EvidenceRoutes::Get),
       kHasQuery, kIsSlow},
      {HttpMethod::kGet, "/api/v1/objects/{id}/decisions", Role::kViewer, Of(parts.objects, &ObjectRoutes::Decisions)},
      {HttpMethod::kPut, "/api/v1/objects/{id}/review", Role::kAnalyst, Of(parts.objects, &ObjectRoutes::PutReview)},
      {HttpMethod::kPost, "/api/v1/objects/regroup", Role::kAnalyst, Of(parts.objects, &ObjectRoutes::Regroup),
       !kHasQuery, kIsSlow},
      {HttpMethod::kPost, "/api/v1/uploads", Role::kAnalyst, Of(parts.jobs, &JobRoutes::Upload), kHasQuery, !kIsSlow,
       kIsUpload},
      {HttpMethod::kGet, "/api/v1/cluster", Role::kViewer, Of(parts.cluster, &ClusterRoutes::List)},
      {HttpMethod::kGet, "/api/v1/jobs", Role::kViewer, Of(parts.jobs, &JobRoutes::List)},
      {HttpMethod::kPost, "/api/v1/jobs", Role::kAnalyst, Of(parts.jobs, &JobRoutes::Submit), !kHasQuery, kIsSlow},
      {HttpMethod::kPost, "/api/v1/jobs/{id}/cancel", Role::kAnalyst, Of(parts.jobs, &JobRoutes::Cancel)},
      {HttpMethod::kPost, "/api/v1/jobs/{id}/retry", Role::kAnalyst, Of(parts.jobs, &JobRoutes::Retry)},
      {HttpMethod::kDelete, "/api/v1/jobs/{id}", Role::kAnalyst, Of(parts.jobs, &JobRoutes::Remove)},
      {HttpMethod::kGet, "/api/v1/jobs/{id}/files/{name}", Role::kViewer, Of(parts.jobs, &JobRoutes::File)},
      {HttpMethod::kGet, "/api/v1/events", Role::kViewer, Of(parts.jobs, &JobRoutes::Events)},
      {HttpMethod::kGet, "/api/v1/thresholds", Role::kViewer, Of(parts.thresholds, &ThresholdRoutes::List)},
      {HttpMethod::kPut, "/api/v1/models/{id}/threshold", Role::kAnalyst, Of(parts.thresholds, &ThresholdRoutes::Put)},
      {HttpMethod::kGet, "/api/v1/models/{id}/coverage", Role::kViewer, Of(parts.evidence, &EvidenceRoutes::Coverage),
       kHasQuery, kIsSlow},
      {HttpMethod::kGet, "/api/v1/models/{id}/views", Role::kViewer, Of(parts.evidence, &EvidenceRoutes::Views)},
      {HttpMethod::kGet, "/api/v1/models/{id}/views/{view}", Role::kViewer,
       Of(parts.evidence, &EvidenceRoutes::ViewImage), kHasQuery},
      {HttpMethod::kGet, "/healthz", std::nullopt, Of(parts.operation, &OperationRoutes::Health), !kHasQuery, !kIsSlow,
       !kIsUpload, kIsProbe},
      {HttpMethod::kGet, "/metrics", Role::kAdmin, Of(parts.operation, &OperationRoutes::Metrics)},
      {HttpMethod::kGet, "/api/v1/audit", Role::kAdmin, Of(parts.session, &SessionRoutes::Audit), kHasQuery},
  };
}

}  // namespace victorious

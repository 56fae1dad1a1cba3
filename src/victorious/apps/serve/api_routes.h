// All routes of the API: the parts that answer them, and the one table of addresses, roles and handlers.
#pragma once

#include <memory>
#include <vector>

#include "victorious/apps/serve/cluster_routes.h"
#include "victorious/apps/serve/evidence_routes.h"
#include "victorious/apps/serve/job_inputs.h"
#include "victorious/apps/serve/job_routes.h"
#include "victorious/apps/serve/object_routes.h"
#include "victorious/apps/serve/operation_routes.h"
#include "victorious/apps/serve/project_routes.h"
#include "victorious/apps/serve/route_table.h"
#include "victorious/apps/serve/session_routes.h"
#include "victorious/apps/serve/threshold_routes.h"
#include "victorious/apps/serve/video_routes.h"

namespace victorious {

/// What the routes share. All must outlive them.
struct SharedByRoutes {
  const ApiOptions& options;
  IndexView& index;
  AccessControl& access;
  LiveService& live;
  VideoFiles& videos;
  CopyFolder& copies;
  UploadFolder& uploads;
  std::shared_ptr<const ServerMetrics> metrics;
};

/// What answers the routes. Each part has only what it needs.
struct RouteParts {
  /// @param thresholds  takes what is put into force
  RouteParts(const SharedByRoutes& shared, std::unique_ptr<ThresholdStore> thresholds);
  RouteParts(const RouteParts&) = delete;
  RouteParts& operator=(const RouteParts&) = delete;

  SessionRoutes session;
  JobInputs inputs;  ///< of `project` and `jobs`
  ProjectRoutes project;
  VideoRoutes videos;
  ObjectRoutes objects;
  EvidenceRoutes evidence;
  JobRoutes jobs;
  ClusterRoutes cluster;
  OperationRoutes operation;
  ThresholdRoutes thresholds;
};

/// @param parts  must outlive the routes
[[nodiscard]] std::vector<ApiRoute> MakeRoutes(RouteParts& parts);

}  // namespace victorious

// All routes of the API: the parts that answer them, and the one table of addresses, roles and handlers.
#pragma once

#include <memory>
#include <vector>

#include "victorious/serve/cluster_routes.h"
#include "victorious/serve/evidence_routes.h"
#include "victorious/serve/job_inputs.h"
#include "victorious/serve/job_routes.h"
#include "victorious/serve/object_routes.h"
#include "victorious/serve/operation_routes.h"
#include "victorious/serve/project_routes.h"
#include "victorious/serve/route_table.h"
#include "victorious/serve/session_routes.h"
#include "victorious/serve/threshold_routes.h"
#include "victorious/serve/video_routes.h"

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

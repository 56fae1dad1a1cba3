// The routes for who runs the server: whether it works, and its numbers. Thread-safe.
#pragma once

#include <memory>
#include <utility>

#include "victorious/apps/serve/access_control.h"
#include "victorious/apps/serve/cluster_routes.h"
#include "victorious/apps/serve/live_service.h"
#include "victorious/apps/serve/route_table.h"
#include "victorious/apps/serve/server_metrics.h"

namespace victorious {

class OperationRoutes {
 public:
  /// All must outlive this.
  OperationRoutes(AccessControl& access, LiveService& live, ClusterRoutes& cluster,
                  std::shared_ptr<const ServerMetrics> metrics)
      : access_(access), live_(live), cluster_(cluster), metrics_(std::move(metrics)) {}

  /// Asks the store. Says nothing else, since everybody may ask.
  ApiExpected<HttpResponse> Health(const ApiCall& call);
  ApiExpected<HttpResponse> Metrics(const ApiCall& call);

 private:
  AccessControl& access_;
  LiveService& live_;
  ClusterRoutes& cluster_;
  std::shared_ptr<const ServerMetrics> metrics_;
};

}  // namespace victorious

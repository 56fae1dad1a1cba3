// The routes of the whole: what the server has and can, and its base map. Thread-safe.
#pragma once

#include "victorious/apps/serve/api_options.h"
#include "victorious/apps/serve/index_view.h"
#include "victorious/apps/serve/job_inputs.h"
#include "victorious/apps/serve/live_service.h"
#include "victorious/apps/serve/route_table.h"

namespace victorious {

class ProjectRoutes {
 public:
  /// All must outlive this.
  ProjectRoutes(const ApiOptions& options, IndexView& index, const LiveService& live, const JobInputs& inputs)
      : options_(options), index_(index), live_(live), inputs_(inputs) {}

  ApiExpected<HttpResponse> Get(const ApiCall& call);
  ApiExpected<HttpResponse> BaseMapFile(const ApiCall& call);

 private:
  const ApiOptions& options_;
  IndexView& index_;
  const LiveService& live_;
  const JobInputs& inputs_;
};

}  // namespace victorious

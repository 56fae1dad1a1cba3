// The routes of uploads, jobs and events. Thread-safe.
#pragma once

#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "victorious/serve/access_control.h"
#include "victorious/serve/api_options.h"
#include "victorious/serve/copy_folder.h"
#include "victorious/serve/index_view.h"
#include "victorious/serve/job_inputs.h"
#include "victorious/serve/live_service.h"
#include "victorious/serve/route_table.h"
#include "victorious/serve/upload_folder.h"

namespace victorious {

class JobRoutes {
 public:
  /// What they share with other routes. All must outlive this.
  struct Needs {
    const ApiOptions& options;
    IndexView& index;
    AccessControl& access;
    LiveService& live;
    JobInputs& inputs;
    CopyFolder& copies;
    UploadFolder& uploads;
  };
  explicit JobRoutes(const Needs& needs) : needs_(needs) {}

  /// Where the body of an upload goes. Errors: kPermissionDenied without jobs; kInvalidArgument for a name.
  ApiExpected<UploadPlan> PlanUpload(const RequestTarget& target);

  ApiExpected<HttpResponse> Upload(const ApiCall& call);
  ApiExpected<HttpResponse> List(const ApiCall& call);
  ApiExpected<HttpResponse> Submit(const ApiCall& call);
  ApiExpected<HttpResponse> Cancel(const ApiCall& call);
  ApiExpected<HttpResponse> Retry(const ApiCall& call);
  ApiExpected<HttpResponse> Remove(const ApiCall& call);
  ApiExpected<HttpResponse> File(const ApiCall& call);
  ApiExpected<HttpResponse> Events(const ApiCall& call);

 private:
  /// Submits three jobs: the model of its object, the flight, its search. Returns the second.
  ApiExpected<HttpResponse> SubmitSample(const Json& input, const std::string& actor);
  /// Fails with kConflict if there is nothing that a video could be searched for, nor will be.
  ApiStatus CheckHasTargets();
  /// The job of an id in the address. Errors: kNotFound; those of LiveService::Find.
  ApiExpected<JobRecord> FindJob(const std::string& id);
  /// A listed job that has made what is asked for; std::nullopt: none, or its file was removed.
  ApiExpected<std::optional<JobRecord>> FindMade(const NewJob& asked);
  /// Removes what was uploaded for a removed job, unless another job or a video of the index needs it.
  [[nodiscard]] Status RemoveUploads(const JobRecord& removed);
  /// The file that a job has made, to be saved under the job's title.
  ApiExpected<HttpResponse> SendJobFile(const HttpRequest& request, const JobRecord& job, const std::string& name);

  Needs needs_;
};

}  // namespace victorious

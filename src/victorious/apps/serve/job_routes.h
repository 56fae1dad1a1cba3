// The routes of uploads, jobs and events. Thread-safe.
#pragma once

#include <mutex>
#include <optional>
#include <set>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "victorious/apps/serve/access_control.h"
#include "victorious/apps/serve/account_quota.h"
#include "victorious/apps/serve/api_options.h"
#include "victorious/apps/serve/copy_folder.h"
#include "victorious/apps/serve/index_view.h"
#include "victorious/apps/serve/job_inputs.h"
#include "victorious/apps/serve/live_service.h"
#include "victorious/apps/serve/route_table.h"
#include "victorious/apps/serve/upload_folder.h"

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
  explicit JobRoutes(const Needs& needs);

  /// Where the body of an upload goes. Removes uploads that nobody has used for too long. Errors: kPermissionDenied
  /// without jobs; kInvalidArgument for a name; kConflict if there are too many.
  ApiExpected<UploadPlan> PlanUpload(const RequestTarget& target, const Caller& caller);

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
  /// The uploads that a job or a video of the index names.
  [[nodiscard]] Expected<std::set<std::string>> UsedUploads();
  /// Fails with kConflict if the caller may open no further job.
  ApiStatus CheckQuota(const Caller& caller);
  /// Fails with kPermissionDenied if the input of a job names a live source that the caller may not have opened.
  ApiStatus CheckMayOpen(const std::string& input_json, const Caller& caller);
  /// Removes what was uploaded for a removed job, unless another job or a video of the index needs it.
  [[nodiscard]] Status RemoveUploads(const JobRecord& removed);
  /// The file that a job has made, to be saved under the job's title.
  ApiExpected<HttpResponse> SendJobFile(const HttpRequest& request, const JobRecord& job, const std::string& name);

  Needs needs_;
  std::mutex quota_mutex_;  ///< held while something is counted and added
  AccountQuota upload_quota_;
  AccountQuota job_quota_;
};

}  // namespace victorious

#include "victorious/apps/serve/operation_routes.h"

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace victorious {
namespace {

constexpr const char* kPlainText = "text/plain; charset=utf-8";

HttpResponse TextResponse(int status, const char* content_type, std::string body) {
  HttpResponse response;
  response.status = status;
  response.content_type = content_type;
  response.headers.emplace_back("Cache-Control", "no-store");
  response.body = std::move(body);
  return response;
}

void AddJobs(const std::vector<JobRecord>& jobs, std::vector<MetricSample>& samples) {
  std::map<WorkState, int> of_state = {{WorkState::kQueued, 0}, {WorkState::kRunning, 0}};
  for (const JobRecord& job : jobs) ++of_state[job.state];
  for (const auto& [state, count] : of_state) {
    samples.push_back({.name = "victorious_jobs",
                       .help = "Jobs of the page in the list, by state; queued ones are the length of the queue",
                       .labels = fmt::format("{{state=\"{}\"}}", ToText(state)),
                       .value = static_cast<double>(count)});
  }
  for (const JobRecord& job : jobs) {
    if (job.state != WorkState::kRunning) continue;
    samples.push_back({.name = "victorious_job_progress",
                       .help = "How far a running job has come; its derivative is the rate, of a search in frames",
                       .labels = fmt::format("{{job=\"{}\",kind=\"{}\",unit={}}}", job.id, ToText(job.kind),
                                             MetricLabel(job.progress.unit)),
                       .value = static_cast<double>(job.progress.done)});
  }
}

void AddTasks(std::string_view what, const postgres::TaskCounts& counts, std::vector<MetricSample>& samples) {
  const std::array<std::pair<std::string_view, std::int64_t>, 5> states = {{{"queued", counts.queued},
                                                                            {"waiting", counts.waiting},
                                                                            {"running", counts.running},
                                                                            {"done", counts.done},
                                                                            {"failed", counts.failed}}};
  for (const auto& [state, count] : states) {
    samples.push_back({.name = "victorious_tasks",
                       .help = "Tasks of workers, by state",
                       .labels = fmt::format("{{of=\"{}\",state=\"{}\"}}", what, state),
                       .value = static_cast<double>(count)});
  }
}

void AddCluster(const ClusterStatus& status, std::vector<MetricSample>& samples) {
  AddTasks("video", status.videos, samples);
  AddTasks("segment", status.segments, samples);
  const std::array<std::pair<std::string_view, std::optional<double>>, 2> means = {
      {{"video", status.video_s}, {"segment", status.segment_s}}};
  for (const auto& [what, mean_s] : means) {
    if (!mean_s) continue;
    samples.push_back({.name = "victorious_task_seconds",
                       .help = "Mean time of the last tasks that were done",
                       .labels = fmt::format("{{of=\"{}\"}}", what),
                       .value = *mean_s});
  }
}

}  // namespace

ApiExpected<HttpResponse> OperationRoutes::Health(const ApiCall& /*call*/) {
  if (access_.CheckStore()) return TextResponse(200, kPlainText, "ok\n");
  return TextResponse(503, kPlainText, "not ok\n");
}

ApiExpected<HttpResponse> OperationRoutes::Metrics(const ApiCall& /*call*/) {
  std::vector<MetricSample> samples;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t sessions, access_.CountSessions());
  samples.push_back(
      {.name = "victorious_sessions", .help = "Sessions that have not ended", .value = static_cast<double>(sessions)});
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<JobRecord> jobs, live_.Jobs());
  AddJobs(jobs, samples);
  VICTORIOUS_ASSIGN_OR_RETURN(const auto cluster, cluster_.Status());
  if (cluster) AddCluster(*cluster, samples);
  return TextResponse(200, "text/plain; version=0.0.4; charset=utf-8", metrics_->Text(samples));
}

}  // namespace victorious

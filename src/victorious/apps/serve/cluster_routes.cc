#include "victorious/apps/serve/cluster_routes.h"

#include <set>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "victorious/apps/serve/api_response.h"
#include "victorious/base/json.h"
#include "victorious/store/open_store.h"

namespace victorious {
namespace {

Json TaskCountsToJson(const postgres::TaskCounts& counts) {
  return {{"queued", counts.queued},
          {"waiting", counts.waiting},
          {"running", counts.running},
          {"done", counts.done},
          {"failed", counts.failed}};
}

Json FramesToJson(const FrameInterval& frames) { return Json::array({frames.from, frames.to}); }

Json UtcToJson(const UtcInterval& time) { return {{"from_utc_us", time.from_us}, {"to_utc_us", time.to_us}}; }

Json SourcesToJson(const std::vector<ListedSource>& sources) {
  Json rows = Json::array();
  for (const ListedSource& one : sources) {
    Json gaps = Json::array();
    for (const UtcInterval& gap : one.gaps) gaps.push_back(UtcToJson(gap));
    rows.push_back({{"id", one.record.id},
                    {"source", one.source},
                    {"state", ToText(one.record.state)},
                    {"attempt", one.record.attempt},
                    {"worker", one.record.worker},
                    {"silent_s", OrNull(one.record.silent_s)},
                    {"covered", one.covered ? UtcToJson(*one.covered) : Json()},
                    {"behind_s", OrNull(one.behind_s)},
                    {"gaps", std::move(gaps)},
                    {"reason", one.record.reason}});
  }
  return rows;
}

Json ClusterToJson(const ClusterStatus& status, bool is_shared) {
  std::set<std::string> workers;
  Json tasks = Json::array();
  for (const ListedSource& one : status.sources) {
    if (!one.record.worker.empty()) workers.insert(one.record.worker);
  }
  for (const ListedTask& task : status.tasks) {
    if (!task.record.worker.empty()) workers.insert(task.record.worker);
    tasks.push_back({{"id", task.record.id},
                     {"video", task.video},
                     {"segment", task.frames ? FramesToJson(*task.frames) : Json()},
                     {"state", ToText(task.record.state)},
                     {"attempt", task.record.attempt},
                     {"worker", task.record.worker},
                     {"silent_s", OrNull(task.record.silent_s)},
                     {"searched_frames", OrNull(task.next_frame)},
                     {"reason", task.record.reason}});
  }
  Json gaps = Json::array();
  for (const ListedGap& one : status.gaps) {
    gaps.push_back({{"video", one.video},
                    {"segment", FramesToJson(one.gap.frames)},
                    {"from_s", TimeJson(one.gap.from_s)},
                    {"to_s", TimeJson(one.gap.to_s)},
                    {"reason", one.gap.reason}});
  }
  Json quarantined = Json::array();
  for (const ListedQuarantine& one : status.quarantined) {
    quarantined.push_back(
        {{"video", one.video}, {"segment", FramesToJson(one.segment.frames)}, {"reason", one.segment.reason}});
  }
  return {{"is_shared", is_shared},
          {"workers", workers.size()},
          {"videos", TaskCountsToJson(status.videos)},
          {"segments", TaskCountsToJson(status.segments)},
          {"video_s", OrNull(status.video_s)},
          {"segment_s", OrNull(status.segment_s)},
          {"left_s", OrNull(status.left_s)},
          {"tasks", std::move(tasks)},
          {"gaps", std::move(gaps)},
          {"quarantined", std::move(quarantined)},
          {"sources", SourcesToJson(status.sources)}};
}

}  // namespace

Expected<ClusterStatus> ClusterRoutes::Read() {
  if (!cluster_) {
    VICTORIOUS_ASSIGN_OR_RETURN(cluster_, ClusterReader::Open(index_));
  }
  return cluster_->Read();
}

Expected<std::optional<ClusterStatus>> ClusterRoutes::Status() {
  if (!IsDatabaseUrl(index_)) return std::nullopt;
  const std::scoped_lock lock(mutex_);
  return Read();
}

ApiExpected<HttpResponse> ClusterRoutes::List(const ApiCall& /*call*/) {
  if (!IsDatabaseUrl(index_)) return JsonResponse(ClusterToJson({}, /*is_shared=*/false));
  constexpr std::chrono::seconds kMaxAge{1};
  const std::scoped_lock lock(mutex_);
  if (body_.empty() || std::chrono::steady_clock::now() - read_ >= kMaxAge) {
    VICTORIOUS_ASSIGN_OR_RETURN(const ClusterStatus status, Read());
    body_ = DumpJson(ClusterToJson(status, /*is_shared=*/true)) + "\n";
    read_ = std::chrono::steady_clock::now();
  }
  return JsonTextResponse(body_);
}

}  // namespace victorious

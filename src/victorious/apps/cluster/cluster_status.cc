#include "victorious/apps/cluster/cluster_status.h"

#include <algorithm>
#include <unordered_map>
#include <utility>

#include "victorious/apps/cluster/index_task.h"
#include "victorious/base/credentials.h"
#include "victorious/base/utc.h"
#include "victorious/store/postgres/migrations.h"
#include "victorious/store/postgres/postgres_database.h"
#include "victorious/store/postgres/postgres_segment_store.h"
#include "victorious/store/postgres/postgres_store.h"
#include "victorious/store/sql/sql_triage_store.h"

namespace victorious {
namespace {

std::string NameOf(std::int64_t video, const std::vector<VideoRecord>& videos) {
  const auto found = std::ranges::find(videos, video, &VideoRecord::id);
  return found == videos.end() ? "?" : ShownName(*found);
}

// How far the searches of each video are, by its name.
std::unordered_map<std::string, std::int64_t> NextFrames(const std::vector<VideoRecord>& videos,
                                                         const std::vector<SearchRecord>& searches) {
  std::unordered_map<std::int64_t, std::int64_t> by_id;
  for (const SearchRecord& search : searches) {
    const auto [found, is_new] = by_id.try_emplace(search.video, search.next_frame);
    found->second = std::min(found->second, search.next_frame);
  }
  std::unordered_map<std::string, std::int64_t> by_name;
  for (const VideoRecord& video : videos) {
    if (const auto found = by_id.find(video.id); found != by_id.end()) by_name[video.name] = found->second;
  }
  return by_name;
}

// The time for what is queued at the present rate. What runs is half done, on average.
std::optional<double> TimeLeft(const postgres::TaskCounts& counts, const std::optional<double>& mean_s) {
  if (!mean_s || counts.running == 0) return std::nullopt;
  return (static_cast<double>(counts.queued) / static_cast<double>(counts.running) + 0.5) * *mean_s;
}

bool IsRunningVideo(const ListedTask& task) { return task.record.state == WorkState::kRunning && !task.frames; }

}  // namespace

ClusterReader::ClusterReader(std::shared_ptr<postgres::Connection> connection)
    : store_(std::make_unique<postgres::PostgresStore>(connection)),
      searches_(sql::MakeTriageStore(postgres::MakeSqlDatabase(connection))),
      queue_(postgres::TaskQueue::On(connection, {.worker = "status", .program = {}, .is_read_only = true})),
      segments_(MakePostgresSegmentStore(connection)) {}

Expected<std::unique_ptr<ClusterReader>> ClusterReader::Open(const std::string& url) {
  VICTORIOUS_ASSIGN_OR_RETURN(std::shared_ptr<postgres::Connection> connection,
                              postgres::OpenIndex(url, StoreMode::kRead));
  return std::unique_ptr<ClusterReader>(new ClusterReader(std::move(connection)));
}

std::vector<UtcInterval> GapsBetween(std::span<const CoveredTime> covered) {
  std::vector<UtcInterval> gaps;
  std::optional<std::int64_t> end_us;
  for (const CoveredTime& one : covered) {
    if (end_us && one.from_utc_us - *end_us >= kMinGap_us) gaps.push_back({*end_us, one.from_utc_us});
    end_us = std::max(one.to_utc_us, end_us.value_or(one.to_utc_us));
  }
  return gaps;
}

Expected<std::vector<ListedSource>> ClusterReader::ReadSources() {
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<postgres::TaskRecord> records, queue_->ListLasting());
  std::vector<ListedSource> sources;
  for (postgres::TaskRecord& record : records) {
    const Expected<IndexTask> work = FromQueue(record.kind, record.payload);
    ListedSource listed{.record = std::move(record), .source = work ? work->video : ""};
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<CoveredTime> covered, store_->CoveredTimes(listed.source));
    if (!covered.empty()) {
      const std::int64_t end_us = std::ranges::max(covered, {}, &CoveredTime::to_utc_us).to_utc_us;
      listed.covered = {covered.front().from_utc_us, end_us};
      listed.behind_s = std::max(0.0, static_cast<double>(NowUtcMicroseconds() - end_us) / 1e6);
      listed.gaps = GapsBetween(covered);
    }
    listed.source = WithoutCredentials(listed.source);
    listed.record.reason = WithoutCredentials(listed.record.reason);
    sources.push_back(std::move(listed));
  }
  return sources;
}

Expected<ClusterStatus> ClusterReader::Read() {
  ClusterStatus status;
  VICTORIOUS_ASSIGN_OR_RETURN(status.videos, queue_->Count());
  VICTORIOUS_ASSIGN_OR_RETURN(status.segments, queue_->CountParts());
  VICTORIOUS_ASSIGN_OR_RETURN(status.video_s, queue_->MeanSeconds());
  VICTORIOUS_ASSIGN_OR_RETURN(status.segment_s, queue_->MeanPartSeconds());
  VICTORIOUS_ASSIGN_OR_RETURN(status.sources, ReadSources());
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<postgres::TaskRecord> records, queue_->List(ClusterStatus::kMaxListed));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<CoverageGap> gaps, segments_->Gaps());
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<QuarantinedSegment> quarantined, segments_->Quarantined());
  for (postgres::TaskRecord& record : records) {
    const Expected<IndexTask> work = FromQueue(record.kind, record.payload);
    record.reason = WithoutCredentials(record.reason);
    ListedTask task{.record = std::move(record), .video = work ? work->video : "", .frames = {}, .next_frame = {}};
    if (work && work->part) task.frames = work->part->frames;
    status.tasks.push_back(std::move(task));
  }
  std::vector<VideoRecord> videos;
  const bool is_searched = std::ranges::any_of(status.tasks, IsRunningVideo);
  if (is_searched || !gaps.empty() || !quarantined.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(videos, store_->Videos());
  }
  if (is_searched) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<SearchRecord> searches, searches_->Searches());
    const auto next_frames = NextFrames(videos, searches);
    for (ListedTask& task : status.tasks) {
      if (!IsRunningVideo(task)) continue;
      if (const auto found = next_frames.find(task.video); found != next_frames.end()) task.next_frame = found->second;
    }
  }
  for (ListedTask& task : status.tasks) task.video = WithoutCredentials(task.video);
  for (const CoverageGap& gap : gaps) status.gaps.push_back({NameOf(gap.video, videos), gap});
  for (const QuarantinedSegment& one : quarantined) status.quarantined.push_back({NameOf(one.video, videos), one});
  // Into how many segments the queued videos will be cut is not known.
  const bool are_cut = status.segments.queued + status.segments.running > 0;
  if (!are_cut && status.videos.waiting == 0) status.left_s = TimeLeft(status.videos, status.video_s);
  if (are_cut && status.videos.queued == 0) status.left_s = TimeLeft(status.segments, status.segment_s);
  return status;
}

}  // namespace victorious

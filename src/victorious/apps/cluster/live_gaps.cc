#include "victorious/apps/cluster/live_gaps.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "victorious/apps/cluster/index_task.h"
#include "victorious/base/absolute_path.h"
#include "victorious/input/video/frame_times.h"
#include "victorious/input/video/stream_recorder.h"
#include "victorious/store/postgres/migrations.h"
#include "victorious/store/postgres/postgres_store.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;

// Two machines tell the time of the same frame by so much differently: less than half the time from frame to frame.
constexpr std::int64_t kSameFrame_us = 15'000;

std::int64_t EndOf(std::span<const CoveredTime> covered) {
  return covered.empty() ? 0 : std::ranges::max(covered, {}, &CoveredTime::to_utc_us).to_utc_us;
}

IndexTask TaskOf(const IndexTask& live, const postgres::Recording& recording, const UtcInterval& part) {
  const auto time_of = [&](std::int64_t utc_us) {
    return fmt::format("{:.6f}", static_cast<double>(std::max<std::int64_t>(0, utc_us - recording.from_utc_us)) / 1e6);
  };
  IndexTask task = live;
  task.is_live = false;
  task.video = recording.path;
  task.covers = recording.source;
  task.options.insert(task.options.end(), {"--from", time_of(part.from_us), "--to", time_of(part.to_us)});
  return task;
}

}  // namespace

std::vector<UtcInterval> PartsToSearch(const postgres::Recording& recording, std::span<const CoveredTime> covered) {
  const std::int64_t before_us = recording.from_utc_us - kMinGap_us;
  const std::int64_t after_us = recording.to_utc_us + kMinGap_us;
  std::vector<CoveredTime> bounded(covered.begin(), covered.end());
  bounded.insert(bounded.begin(), {.from_utc_us = before_us, .to_utc_us = before_us});
  bounded.push_back({.from_utc_us = after_us, .to_utc_us = after_us});
  std::ranges::stable_sort(bounded, {}, &CoveredTime::from_utc_us);
  std::vector<UtcInterval> parts;
  for (const UtcInterval& gap : GapsBetween(bounded)) {
    const UtcInterval part{std::max(gap.from_us + kSameFrame_us, recording.from_utc_us),
                           std::min(gap.to_us - kSameFrame_us, recording.to_utc_us)};
    if (part.from_us <= part.to_us) parts.push_back(part);
  }
  return parts;
}

Status EnterRecordings(const std::string& folder, const std::string& source, postgres::RecordingStore& store,
                       const CancelToken& cancel) {
  const fs::path absolute = AbsolutePath(folder);
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<RecordedFile> files, ListRecordings(absolute));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<postgres::Recording> known, store.Of(source));
  for (const postgres::Recording& one : known) {
    const auto is_it = [&](const RecordedFile& file) { return file.path == one.path; };
    const bool is_here = fs::path(one.path).parent_path() == absolute;
    if (is_here && std::ranges::none_of(files, is_it)) VICTORIOUS_RETURN_IF_ERROR(store.Remove(one.path));
  }
  for (const RecordedFile& file : files) {
    if (std::ranges::find(known, file.path.string(), &postgres::Recording::path) != known.end()) continue;
    const Expected<std::vector<double>> times_s = ReadFrameTimes(file.path.string(), std::nullopt, cancel);
    if (!times_s && times_s.error().code == ErrorCode::kCancelled) return std::unexpected(times_s.error());
    if (!times_s || times_s->empty()) continue;  // removed meanwhile, or without a frame that can be decoded
    const auto length_us = static_cast<std::int64_t>(1e6 * times_s->back());
    VICTORIOUS_RETURN_IF_ERROR(store.Put({.path = file.path.string(),
                                          .source = source,
                                          .from_utc_us = file.start_utc_us,
                                          .to_utc_us = file.start_utc_us + length_us}));
  }
  return {};
}

Expected<std::unique_ptr<LiveGaps>> LiveGaps::Open(const std::string& url, const std::string& program) {
  VICTORIOUS_ASSIGN_OR_RETURN(std::shared_ptr<postgres::Connection> connection,
                              postgres::OpenIndex(url, StoreMode::kCreate));
  return std::unique_ptr<LiveGaps>(new LiveGaps(std::move(connection), program));
}

LiveGaps::LiveGaps(std::shared_ptr<postgres::Connection> connection, std::string program)
    : store_(std::make_unique<postgres::PostgresStore>(connection)),
      queue_(postgres::TaskQueue::On(connection, {.worker = "gaps", .program = program})),
      recordings_(std::make_unique<postgres::RecordingStore>(std::move(connection))),
      program_(std::move(program)) {}

Expected<std::int64_t> LiveGaps::Queue() {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<postgres::Recording> recordings, recordings_->Unsettled());
  if (recordings.empty()) return 0;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<postgres::TaskRecord> sources,
                              queue_->ListLasting(postgres::LastingTasks::kAll));
  std::int64_t queued = 0;
  for (const postgres::Recording& recording : recordings) {
    const auto live = std::ranges::find_if(sources, [&](const postgres::TaskRecord& source) {
      const Expected<IndexTask> work = FromQueue(source.kind, source.payload);
      return work && work->video == recording.source && work->program == program_;
    });
    if (live == sources.end()) continue;
    VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t parts, QueueParts(recording, *live));
    queued += parts;
  }
  return queued;
}

Expected<std::int64_t> LiveGaps::QueueParts(const postgres::Recording& recording, const postgres::TaskRecord& live) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<CoveredTime> covered, store_->CoveredTimes(recording.source));
  const bool is_searched_live = live.state == WorkState::kRunning && EndOf(covered) < recording.to_utc_us;
  if (is_searched_live) return 0;
  VICTORIOUS_ASSIGN_OR_RETURN(const IndexTask work, FromQueue(live.kind, live.payload));
  std::vector<postgres::NewTask> tasks;
  for (const UtcInterval& part : PartsToSearch(recording, covered)) {
    VICTORIOUS_ASSIGN_OR_RETURN(postgres::NewTask task,
                                ToQueue(TaskOf(work, recording, part), fmt::format("recording {}", recording.path),
                                        postgres::TaskPriority::kBatch));
    tasks.push_back(std::move(task));
  }
  std::int64_t added = 0;
  if (!tasks.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(const postgres::Submission submission, queue_->Submit(tasks));
    added = submission.added;
  }
  VICTORIOUS_RETURN_IF_ERROR(recordings_->Settle(recording.path));
  return added;
}

}  // namespace victorious

// victorious cluster status --db postgresql://…: what workers do
#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/base/count_text.h"
#include "victorious/base/json.h"
#include "victorious/cli/arguments.h"
#include "victorious/cli/command.h"
#include "victorious/cluster/index_task.h"
#include "victorious/store/open_store.h"
#include "victorious/store/postgres/postgres_segment_store.h"

namespace victorious::cli {
namespace {

constexpr std::int64_t kMaxListed = 1000;

struct ClusterArguments {
  std::string db;
  bool json = false;
};

struct ListedTask {
  postgres::TaskRecord record;
  std::string video;                       ///< empty: not a valid task
  std::optional<FrameInterval> frames;     ///< of a segment
  std::optional<std::int64_t> next_frame;  ///< frames before it were searched for each model whose search has begun
};

// How far the search of a video is.
Expected<std::optional<std::int64_t>> NextFrame(const std::string& name, const std::vector<VideoRecord>& videos,
                                                const std::vector<ModelRecord>& models, IndexStore& store) {
  const auto video = std::ranges::find(videos, name, &VideoRecord::name);
  std::optional<std::int64_t> next;
  if (video == videos.end()) return next;
  for (const ModelRecord& model : models) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<SearchRecord> search, store.FindSearch(video->id, model.id));
    if (search) next = std::min(next.value_or(search->next_frame), search->next_frame);
  }
  return next;
}

nlohmann::ordered_json ToJson(const ListedTask& task) {
  const postgres::TaskRecord& record = task.record;
  nlohmann::ordered_json row = {
      {"video", task.video}, {"state", ToText(record.state)}, {"attempt", record.attempt}, {"program", record.program}};
  if (record.state == WorkState::kRunning) {
    row["worker"] = record.worker;
    row["lease_left_s"] = record.lease_left_s ? nlohmann::ordered_json(*record.lease_left_s) : nlohmann::ordered_json();
    row["frames"] = task.next_frame.value_or(0);
  }
  if (task.frames) row["segment"] = {task.frames->from, task.frames->to};
  row["reason"] = record.reason;
  return row;
}

std::string ToText(const ListedTask& task) {
  const postgres::TaskRecord& record = task.record;
  const std::string segment =
      task.frames ? fmt::format("segment of frames {} to {}", task.frames->from, task.frames->to - 1) : "";
  if (record.state == WorkState::kFailed) {
    return fmt::format("failed   {}  {}{}\n", OneLine(task.video), segment.empty() ? "" : segment + ": ",
                       OneLine(record.reason));
  }
  return fmt::format("running  {}  {}, {}, attempt {}, lease {:.0f} s{}\n", OneLine(task.video),
                     segment.empty() ? fmt::format("{} frames", task.next_frame.value_or(0)) : segment,
                     OneLine(record.worker), record.attempt, record.lease_left_s.value_or(0),
                     record.reason.empty() ? "" : "; last: " + OneLine(record.reason));
}

const std::string& NameOf(std::int64_t video, const std::vector<VideoRecord>& videos) {
  static const std::string kUnknown = "?";
  const auto found = std::ranges::find(videos, video, &VideoRecord::id);
  return found == videos.end() ? kUnknown : found->name;
}

nlohmann::ordered_json ToJson(const CoverageGap& gap, const std::vector<VideoRecord>& videos) {
  return {{"video", NameOf(gap.video, videos)},
          {"segment", {gap.frames.from, gap.frames.to}},
          {"from_s", gap.from_s},
          {"to_s", gap.to_s},
          {"reason", gap.reason}};
}

std::string ToText(const CoverageGap& gap, const std::vector<VideoRecord>& videos) {
  return fmt::format("gap      {}  frames {} to {}, {:.1f} to {:.1f} s, were left out: {}\n",
                     OneLine(NameOf(gap.video, videos)), gap.frames.from, gap.frames.to - 1, gap.from_s, gap.to_s,
                     OneLine(gap.reason));
}

// The time for what is queued at the present rate. What runs is half done, on average.
std::optional<double> HoursLeft(const postgres::TaskCounts& counts, const std::optional<double>& mean_s) {
  if (!mean_s || counts.running == 0) return std::nullopt;
  return (static_cast<double>(counts.queued) / static_cast<double>(counts.running) + 0.5) * *mean_s / 3600;
}

Status Run(const ClusterArguments& arguments) {
  if (!IsDatabaseUrl(arguments.db)) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("--db {}: workers share a database: give postgresql://USER@HOST/DATABASE", arguments.db));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const std::unique_ptr<IndexStore> store, OpenStore(arguments.db, StoreMode::kRead));
  VICTORIOUS_ASSIGN_OR_RETURN(
      const auto queue,
      postgres::TaskQueue::Open(arguments.db, {.worker = "status", .program = {}, .is_read_only = true}));
  VICTORIOUS_ASSIGN_OR_RETURN(const postgres::TaskCounts counts, queue->Count());
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<postgres::TaskRecord> records, queue->List(kMaxListed));
  VICTORIOUS_ASSIGN_OR_RETURN(const postgres::TaskCounts segments, queue->CountParts());
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<double> mean_s, queue->MeanSeconds());
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<double> segment_mean_s, queue->MeanPartSeconds());
  VICTORIOUS_ASSIGN_OR_RETURN(const auto segment_store, OpenPostgresSegmentStore(arguments.db, StoreMode::kRead));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<CoverageGap> gaps, segment_store->Gaps());
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<VideoRecord> videos, store->Videos());
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ModelRecord> models, store->Models());
  std::vector<ListedTask> tasks;
  for (postgres::TaskRecord& record : records) {
    const Expected<IndexTask> work = FromQueue(record.kind, record.payload);
    ListedTask task{.record = std::move(record), .video = work ? work->video : "", .frames = {}, .next_frame = {}};
    if (work && work->part) task.frames = work->part->frames;
    if (task.record.state == WorkState::kRunning && !task.frames) {
      VICTORIOUS_ASSIGN_OR_RETURN(task.next_frame, NextFrame(task.video, videos, models, *store));
    }
    tasks.push_back(std::move(task));
  }
  // Into how many segments the queued videos will be cut is not known.
  const bool are_cut = segments.queued + segments.running > 0;
  std::optional<double> hours_left;
  if (!are_cut && counts.waiting == 0) hours_left = HoursLeft(counts, mean_s);
  if (are_cut && counts.queued == 0) hours_left = HoursLeft(segments, segment_mean_s);
  if (arguments.json) {
    const auto number = [](const std::optional<double>& value) {
      return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json();
    };
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (const ListedTask& task : tasks) rows.push_back(ToJson(task));
    nlohmann::ordered_json gap_rows = nlohmann::ordered_json::array();
    for (const CoverageGap& gap : gaps) gap_rows.push_back(ToJson(gap, videos));
    const nlohmann::ordered_json status = {{"queued", counts.queued},
                                           {"waiting", counts.waiting},
                                           {"running", counts.running},
                                           {"done", counts.done},
                                           {"failed", counts.failed},
                                           {"segments",
                                            {{"queued", segments.queued},
                                             {"running", segments.running},
                                             {"done", segments.done},
                                             {"failed", segments.failed}}},
                                           {"seconds_per_video", number(mean_s)},
                                           {"seconds_per_segment", number(segment_mean_s)},
                                           {"hours_left", number(hours_left)},
                                           {"tasks", std::move(rows)},
                                           {"gaps", std::move(gap_rows)}};
    return WriteOutput("", DumpJson(status, 2) + "\n");
  }
  std::string text = fmt::format("{} queued, {} running, {} done, {} failed", counts.queued,
                                 counts.running + counts.waiting, counts.done, counts.failed);
  if (mean_s) text += fmt::format("; {:.0f} s a video", *mean_s);
  if (counts.waiting > 0) {
    text += fmt::format("\nsegments of {}: {} queued, {} running", CountText(counts.waiting, "video"), segments.queued,
                        segments.running);
    if (segment_mean_s) text += fmt::format("; {:.0f} s a segment", *segment_mean_s);
  }
  if (hours_left) text += fmt::format(", about {:.1f} hours left", *hours_left);
  text += "\n";
  for (const ListedTask& task : tasks) text += ToText(task);
  for (const CoverageGap& gap : gaps) text += ToText(gap, videos);
  return WriteOutput("", text);
}

}  // namespace

Action SetUpCluster(ArgumentParser& parser) {
  const auto arguments = std::make_shared<ClusterArguments>();
  parser.RequireCommand();
  ArgumentParser status = parser.AddCommand(
      "status", "Videos that are queued, run, are done or have failed; rate, time left, and frames that were left out");
  status.Add("--db", arguments->db, "The index: postgresql://USER@HOST/DATABASE").Required().TypeName("URL");
  status.AddFlag("--json", arguments->json, "Print one JSON object");
  return [=] { return Run(*arguments); };
}

}  // namespace victorious::cli

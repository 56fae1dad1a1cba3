// victorious cluster status|end --db postgresql://…: what workers do, and the end of a live source
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <ranges>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/apps/cli/arguments.h"
#include "victorious/apps/cli/command.h"
#include "victorious/apps/cluster/cluster_status.h"
#include "victorious/apps/cluster/index_task.h"
#include "victorious/base/count_text.h"
#include "victorious/base/credentials.h"
#include "victorious/base/json.h"
#include "victorious/base/utc.h"
#include "victorious/types/json_values.h"

namespace victorious::cli {
namespace {

struct ClusterArguments {
  std::string db;
  bool json = false;
  std::string source;
};

nlohmann::ordered_json ToJson(const ListedTask& task) {
  const postgres::TaskRecord& record = task.record;
  nlohmann::ordered_json row = {
      {"video", task.video}, {"state", ToText(record.state)}, {"attempt", record.attempt}, {"program", record.program}};
  if (record.state == WorkState::kRunning) {
    row["worker"] = record.worker;
    row["lease_left_s"] = OrNull(record.lease_left_s);
    row["silent_s"] = OrNull(record.silent_s);
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
                     segment.empty() ? CountText(task.next_frame.value_or(0), "frame") : segment,
                     OneLine(record.worker), record.attempt, record.lease_left_s.value_or(0),
                     record.reason.empty() ? "" : "; last: " + OneLine(record.reason));
}

nlohmann::ordered_json ToJson(const ListedGap& listed) {
  const CoverageGap& gap = listed.gap;
  return {{"video", listed.video},
          {"segment", {gap.frames.from, gap.frames.to}},
          {"from_s", gap.from_s},
          {"to_s", gap.to_s},
          {"reason", gap.reason}};
}

nlohmann::ordered_json ToJson(const ListedQuarantine& listed) {
  const QuarantinedSegment& segment = listed.segment;
  return {{"video", listed.video}, {"segment", {segment.frames.from, segment.frames.to}}, {"reason", segment.reason}};
}

std::string ToText(const ListedGap& listed) {
  const CoverageGap& gap = listed.gap;
  return fmt::format("gap      {}  frames {} to {}, {:.1f} to {:.1f} s, were left out: {}\n", OneLine(listed.video),
                     gap.frames.from, gap.frames.to - 1, gap.from_s, gap.to_s, OneLine(gap.reason));
}

std::string ToText(const ListedQuarantine& listed) {
  const QuarantinedSegment& segment = listed.segment;
  return fmt::format("gap      {}  frames {} to {} will be left out: {}\n", OneLine(listed.video), segment.frames.from,
                     segment.frames.to - 1, OneLine(segment.reason));
}

nlohmann::ordered_json ToJson(const UtcInterval& time) {
  return {{"from_utc", FormatUtc(time.from_us, 3)}, {"to_utc", FormatUtc(time.to_us, 3)}};
}

nlohmann::ordered_json ToJson(const ListedSource& listed) {
  const postgres::TaskRecord& record = listed.record;
  nlohmann::ordered_json gaps = nlohmann::ordered_json::array();
  for (const UtcInterval& gap : listed.gaps) gaps.push_back(ToJson(gap));
  return {{"source", listed.source},
          {"state", ToText(record.state)},
          {"worker", record.worker},
          {"attempt", record.attempt},
          {"program", record.program},
          {"lease_left_s", OrNull(record.lease_left_s)},
          {"silent_s", OrNull(record.silent_s)},
          {"covered", listed.covered ? ToJson(*listed.covered) : nlohmann::ordered_json()},
          {"behind_s", OrNull(listed.behind_s)},
          {"gaps", std::move(gaps)},
          {"reason", record.reason}};
}

template <typename Listed>
nlohmann::ordered_json ToJson(const std::vector<Listed>& all) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const Listed& one : all) rows.push_back(ToJson(one));
  return rows;
}

std::string ToText(const ListedSource& listed) {
  constexpr std::size_t kMaxGaps = 20;  // the newest
  const postgres::TaskRecord& record = listed.record;
  const std::string source = OneLine(listed.source);
  const std::string owner = record.state == WorkState::kRunning
                                ? fmt::format("{}, attempt {}", OneLine(record.worker), record.attempt)
                                : fmt::format("no worker ({})", ToText(record.state));
  std::string text = fmt::format("live     {}  {}, {}{}\n", source, owner,
                                 listed.behind_s ? fmt::format("{:.0f} s behind", *listed.behind_s) : "nothing yet",
                                 record.reason.empty() ? "" : "; last: " + OneLine(record.reason));
  const std::size_t hidden = std::max(listed.gaps.size(), kMaxGaps) - kMaxGaps;
  if (hidden > 0) text += fmt::format("gap      {}  {} earlier ones; --json lists all\n", source, hidden);
  for (const UtcInterval& gap : listed.gaps | std::views::drop(hidden)) {
    text += fmt::format("gap      {}  {} to {}, {:.1f} s, was not indexed\n", source, FormatUtc(gap.from_us, 1),
                        FormatUtc(gap.to_us, 1), static_cast<double>(gap.to_us - gap.from_us) / 1e6);
  }
  return text;
}

Status EndSource(const ClusterArguments& arguments) {
  VICTORIOUS_RETURN_IF_ERROR(CheckSharedDatabase(arguments.db));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto queue,
                              postgres::TaskQueue::Open(arguments.db, {.worker = "end", .program = {}}));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<postgres::TaskRecord> records, queue->ListLasting());
  std::vector<std::int64_t> as_shown;
  for (const postgres::TaskRecord& record : records) {
    const Expected<IndexTask> work = FromQueue(record.kind, record.payload);
    if (!work) continue;
    if (work->video == arguments.source) return queue->End(record.id);
    if (WithoutCredentials(work->video) == arguments.source) as_shown.push_back(record.id);
  }
  if (as_shown.size() == 1) return queue->End(as_shown.front());
  if (as_shown.empty()) {
    return Fail(
        ErrorCode::kNotFound,
        fmt::format("{}: no such live source is indexed; `victorious cluster status` lists them", arguments.source));
  }
  return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: {} live sources are shown so: give the whole address",
                                                       arguments.source, as_shown.size()));
}

Status Run(const ClusterArguments& arguments) {
  VICTORIOUS_RETURN_IF_ERROR(CheckSharedDatabase(arguments.db));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, ClusterReader::Open(arguments.db));
  VICTORIOUS_ASSIGN_OR_RETURN(const ClusterStatus status, reader->Read());
  const postgres::TaskCounts& counts = status.videos;
  const postgres::TaskCounts& segments = status.segments;
  std::optional<double> hours_left;
  if (status.left_s) hours_left = *status.left_s / 3600;
  if (arguments.json) {
    const nlohmann::ordered_json json = {{"queued", counts.queued},
                                         {"waiting", counts.waiting},
                                         {"running", counts.running},
                                         {"done", counts.done},
                                         {"failed", counts.failed},
                                         {"segments",
                                          {{"queued", segments.queued},
                                           {"running", segments.running},
                                           {"done", segments.done},
                                           {"failed", segments.failed}}},
                                         {"seconds_per_video", OrNull(status.video_s)},
                                         {"seconds_per_segment", OrNull(status.segment_s)},
                                         {"hours_left", OrNull(hours_left)},
                                         {"tasks", ToJson(status.tasks)},
                                         {"gaps", ToJson(status.gaps)},
                                         {"quarantined", ToJson(status.quarantined)},
                                         {"sources", ToJson(status.sources)}};
    return WriteOutput("", DumpJson(json, 2) + "\n");
  }
  std::string text = fmt::format("{} queued, {} running, {} done, {} failed", counts.queued,
                                 counts.running + counts.waiting, counts.done, counts.failed);
  if (status.video_s) text += fmt::format("; {:.0f} s a video", *status.video_s);
  if (counts.waiting > 0) {
    text += fmt::format("\nsegments of {}: {} queued, {} running", CountText(counts.waiting, "video"), segments.queued,
                        segments.running);
    if (status.segment_s) text += fmt::format("; {:.0f} s a segment", *status.segment_s);
  }
  if (hours_left)
    text += *hours_left < 1 ? fmt::format(", about {:.0f} min left", std::ceil(60 * *hours_left))
                            : fmt::format(", about {:.1f} hours left", *hours_left);
  text += "\n";
  for (const ListedSource& source : status.sources) text += ToText(source);
  for (const ListedTask& task : status.tasks) text += ToText(task);
  for (const ListedGap& gap : status.gaps) text += ToText(gap);
  for (const ListedQuarantine& one : status.quarantined) text += ToText(one);
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
  ArgumentParser end = parser.AddCommand("end", "End the indexing of a live source");
  end.Add("URL", arguments->source, "Its address, as it was submitted or as `status` shows it").Required();
  end.Add("--db", arguments->db, "The index: postgresql://USER@HOST/DATABASE").Required().TypeName("URL");
  return [=] { return end.IsGiven() ? EndSource(*arguments) : Run(*arguments); };
}

}  // namespace victorious::cli

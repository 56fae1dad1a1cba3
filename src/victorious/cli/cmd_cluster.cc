// victorious cluster status --db postgresql://…: what workers do
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
#include "victorious/cluster/cluster_status.h"
#include "victorious/store/export_json.h"
#include "victorious/store/open_store.h"

namespace victorious::cli {
namespace {

struct ClusterArguments {
  std::string db;
  bool json = false;
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
                     segment.empty() ? fmt::format("{} frames", task.next_frame.value_or(0)) : segment,
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

template <typename Listed>
nlohmann::ordered_json ToJson(const std::vector<Listed>& all) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const Listed& one : all) rows.push_back(ToJson(one));
  return rows;
}

Status Run(const ClusterArguments& arguments) {
  if (!IsDatabaseUrl(arguments.db)) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("--db {}: workers share a database: give postgresql://USER@HOST/DATABASE", arguments.db));
  }
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
                                         {"quarantined", ToJson(status.quarantined)}};
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
  if (hours_left) text += fmt::format(", about {:.1f} hours left", *hours_left);
  text += "\n";
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
  return [=] { return Run(*arguments); };
}

}  // namespace victorious::cli

// victorious object join | split | undo --db INDEX: a person corrects which moments are one object
#include <algorithm>
#include <cstdint>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "victorious/apps/cli/arguments.h"
#include "victorious/apps/cli/command.h"
#include "victorious/base/count_text.h"
#include "victorious/base/json.h"
#include "victorious/base/log.h"
#include "victorious/base/one_line.h"
#include "victorious/base/utc.h"
#include "victorious/jobs/regroup_objects.h"
#include "victorious/store/open_store.h"
#include "victorious/types/json_values.h"

namespace victorious::cli {
namespace {

struct ObjectArguments {
  std::string db;
  std::vector<std::int64_t> objects;  // of `join`
  std::int64_t object = 0;            // of `split`
  std::string video;
  std::optional<double> from_s;
  std::optional<double> to_s;
  std::int64_t correction = 0;  // of `undo`
  std::string author;
  bool json = false;
};

Expected<std::unique_ptr<IndexStore>> OpenIndex(const ObjectArguments& arguments) {
  VICTORIOUS_ASSIGN_OR_RETURN(const bool has_index, HasIndex(arguments.db));
  if (!has_index) return Fail(ErrorCode::kNotFound, fmt::format("{}: no such index", StoreName(arguments.db)));
  return OpenStore(arguments.db, StoreMode::kCreate);
}

// @param all  of the index. Error: kNotFound.
Expected<std::vector<TrackletRecord>> MomentsOf(std::int64_t object, const std::vector<TrackletRecord>& all,
                                                const ObjectArguments& arguments) {
  std::vector<TrackletRecord> moments;
  std::ranges::copy_if(all, std::back_inserter(moments), [&](const auto& one) { return one.object == object; });
  if (!moments.empty()) return moments;
  return Fail(ErrorCode::kNotFound, fmt::format("{}: there is no object {}: `victorious search` lists them",
                                                StoreName(arguments.db), object));
}

std::vector<std::int64_t> IdsOf(const std::vector<TrackletRecord>& moments) {
  std::vector<std::int64_t> ids;
  for (const TrackletRecord& one : moments) ids.push_back(one.id);
  return ids;
}

void Warn(const std::string& warning) { LogWarning("{}", OneLine(warning)); }

TrackletGroups GroupsOf(std::vector<std::vector<std::int64_t>> groups, const ObjectArguments& arguments) {
  return {.groups = std::move(groups), .author = arguments.author, .made_utc_us = NowUtcMicroseconds()};
}

// @param line  for a person
Status Print(const RegroupedObjects& regrouped, const std::string& line, const ObjectArguments& arguments) {
  if (arguments.json) {
    return WriteOutput(
        "", DumpJson(Json({{"object_ids", regrouped.objects}, {"correction", regrouped.correction}})) + "\n");
  }
  return WriteOutput("", fmt::format("{} (`victorious object undo {}` takes it back)\n", line, regrouped.correction));
}

Status Join(const ObjectArguments& arguments) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::unique_ptr<IndexStore> store, OpenIndex(arguments));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<TrackletRecord> all, store->Tracklets());
  std::vector<std::int64_t> joined;
  for (auto object = arguments.objects.begin(); object != arguments.objects.end(); ++object) {
    if (std::find(arguments.objects.begin(), object, *object) != object)
      return Fail(ErrorCode::kInvalidArgument, fmt::format("object {} is named twice", *object));
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<TrackletRecord> moments, MomentsOf(*object, all, arguments));
    std::ranges::copy(IdsOf(moments), std::back_inserter(joined));
  }
  const auto count = std::ssize(joined);
  VICTORIOUS_ASSIGN_OR_RETURN(const RegroupedObjects regrouped,
                              RegroupObjects(GroupsOf({std::move(joined)}, arguments), *store, {}, &Warn));
  return Print(regrouped,
               fmt::format("joined objects {}: object {} has {}", fmt::join(arguments.objects, ", "),
                           regrouped.objects.front(), CountText(count, "moment")),
               arguments);
}

bool IsMeant(const TrackletRecord& moment, const VideoRecord& video, const ObjectArguments& arguments) {
  return moment.video == video.id && moment.last_time_s >= arguments.from_s.value_or(moment.last_time_s) &&
         moment.first_time_s <= arguments.to_s.value_or(moment.first_time_s);
}

// "a.mp4 3.0 to 5.1 s, b.mp4 0.0 to 2.0 s".
std::string DescribeMoments(const std::vector<TrackletRecord>& moments, const std::vector<VideoRecord>& videos) {
  std::vector<std::string> texts;
  for (const TrackletRecord& one : moments) {
    const auto video = std::ranges::find(videos, one.video, &VideoRecord::id);
    texts.push_back(fmt::format("{} {:.1f} to {:.1f} s", video == videos.end() ? "" : OneLine(ShownName(*video)),
                                one.first_time_s, one.last_time_s));
  }
  return fmt::format("{}", fmt::join(texts, ", "));
}

Status Split(const ObjectArguments& arguments) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::unique_ptr<IndexStore> store, OpenIndex(arguments));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<TrackletRecord> all, store->Tracklets());
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<TrackletRecord> moments, MomentsOf(arguments.object, all, arguments));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<VideoRecord> videos, store->Videos());
  const std::vector<VideoRecord> named = FindVideosByName(videos, arguments.video);
  const auto is_meant = [&](const TrackletRecord& moment) {
    return std::ranges::any_of(named, [&](const VideoRecord& video) { return IsMeant(moment, video, arguments); });
  };
  std::vector<TrackletRecord> off = moments;
  std::erase_if(off, [&](const TrackletRecord& one) { return !is_meant(one); });
  std::vector<TrackletRecord> rest = moments;
  std::erase_if(rest, is_meant);
  if (off.empty() || rest.empty()) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("object {}: --video, --from and --to select {} of its moments: select some of {}",
                            arguments.object, off.empty() ? "none" : "all", DescribeMoments(moments, videos)));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const RegroupedObjects regrouped,
                              RegroupObjects(GroupsOf({IdsOf(rest), IdsOf(off)}, arguments), *store, {}, &Warn));
  return Print(
      regrouped,
      fmt::format("split object {}: object {} has {}, object {} has {}", arguments.object, regrouped.objects.front(),
                  CountText(std::ssize(rest), "moment"), regrouped.objects.back(), DescribeMoments(off, videos)),
      arguments);
}

Status Undo(const ObjectArguments& arguments) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::unique_ptr<IndexStore> store, OpenIndex(arguments));
  VICTORIOUS_RETURN_IF_ERROR(UndoRegrouping(arguments.correction, GroupsOf({}, arguments), *store, {}, &Warn));
  return WriteOutput("", arguments.json ? DumpJson(Json({{"undone", arguments.correction}})) + "\n"
                                        : fmt::format("took back correction {}\n", arguments.correction));
}

}  // namespace

Action SetUpObject(ArgumentParser& parser) {
  parser.RequireCommand();
  const auto arguments = std::make_shared<ObjectArguments>();
  std::vector<std::pair<ArgumentParser, Status (*)(const ObjectArguments&)>> parts;
  const auto add = [&](const char* name, const char* summary, Status (*run)(const ObjectArguments&),
                       const char* json) -> ArgumentParser {
    ArgumentParser part = parser.AddCommand(name, summary);
    AddDb(part, arguments->db, "The index");
    part.Add("--by", arguments->author, "Who says so, for `victorious user log`").TypeName("NAME");
    part.AddFlag("--json", arguments->json, json);
    parts.emplace_back(part, run);
    return part;
  };
  constexpr const char* kJson = "Print one JSON object: the objects, and the number that `undo` takes";
  ArgumentParser join = add("join", "Say that objects are one; later searches obey it", &Join, kJson);
  join.Add("ID", arguments->objects, "Of the objects, two or more of one model or category").Required();
  ArgumentParser split =
      add("split", "Say that some moments of an object are another one; later searches obey it", &Split, kJson);
  split.Add("ID", arguments->object, "Of the object").Required();
  split.Add("--video", arguments->video, "The moments in this video are split off").Required().TypeName("NAME");
  split.Add("--from", arguments->from_s, "Only those that end at or after this time of the video").TypeName("S");
  split.Add("--to", arguments->to_s, "Only those that begin at or before this time of the video").TypeName("S");
  add("undo", "Take back what `join` or `split` said", &Undo, "Print one JSON object: the number")
      .Add("CORRECTION", arguments->correction, "The number that `join` or `split` printed")
      .Required();
  return [=]() -> Status {
    for (const auto& [part, run] : parts) {
      if (part.IsGiven()) return run(*arguments);
    }
    return {};  // not reached: one of them is required
  };
}

}  // namespace victorious::cli

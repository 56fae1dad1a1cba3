// victorious submit VIDEO... --models DIR --db postgresql://…: videos and live sources to be indexed by workers
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>
#include <oneapi/tbb/parallel_for.h>

#include "victorious/apps/cli/arguments.h"
#include "victorious/apps/cli/command.h"
#include "victorious/apps/cluster/content_file.h"
#include "victorious/apps/cluster/index_task.h"
#include "victorious/base/absolute_path.h"
#include "victorious/base/count_text.h"
#include "victorious/base/file.h"
#include "victorious/base/json.h"
#include "victorious/base/log.h"
#include "victorious/base/program_id.h"
#include "victorious/category/finder/category_source.h"
#include "victorious/input/telemetry/telemetry_file.h"
#include "victorious/input/video/image_folder.h"
#include "victorious/input/video/video_reader.h"
#include "victorious/jobs/index/index_options.h"
#include "victorious/jobs/index/indexer.h"
#include "victorious/jobs/preset.h"
#include "victorious/object/model/model_library.h"
#include "victorious/place/cameras/video_telemetry.h"
#include "victorious/store/open_store.h"

namespace victorious::cli {
namespace {

namespace fs = std::filesystem;

struct SubmitArguments {
  std::vector<std::string> videos;
  std::string models;
  std::string categories;
  std::string db;
  SearchSettings search;
  std::string publish;
  double segment_s = 60;
  bool urgent = false;
  bool redo = false;
  bool json = false;
};

bool IsParamsFile(const SubmitArguments& arguments) {
  return !arguments.search.params.empty() && !FromText(kPresetTexts, arguments.search.params);
}

// The options of `victorious index`, with absolute paths: workers start in other folders.
std::vector<std::string> IndexOptionsOf(const SubmitArguments& arguments) {
  std::vector<std::string> options;
  const auto add = [&](const char* flag, const std::string& value) {
    if (!value.empty()) options.insert(options.end(), {flag, value});
  };
  add("--models", AbsolutePath(arguments.models));
  add("--categories", AbsolutePath(arguments.categories));
  const bool is_file = IsParamsFile(arguments);
  add("--params", is_file ? AbsolutePath(arguments.search.params) : arguments.search.params);
  add("--quality", arguments.search.quality);
  if (arguments.search.every) add("--every", fmt::format("{}", *arguments.search.every));
  return options;
}

// What is searched for and how: the files of the models, categories and parameters.
Expected<std::vector<fs::path>> FilesOfTargets(const SubmitArguments& arguments) {
  std::vector<fs::path> files;
  if (!arguments.models.empty()) {
    const ModelLibrary library(arguments.models);
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<std::string> names, library.Names());
    if (names.empty()) {
      return Fail(ErrorCode::kNotFound,
                  fmt::format("{}: no models; make one with `victorious model add`", arguments.models));
    }
    for (const std::string& name : names) files.push_back(library.PathOf(name));
  }
  if (!arguments.categories.empty()) files.emplace_back(arguments.categories);
  if (IsParamsFile(arguments)) files.emplace_back(arguments.search.params);
  return files;
}

// As of a worker.
Expected<Indexer> MakeIndexer(const SubmitArguments& arguments) {
  std::vector<ObjectModel> models;
  if (!arguments.models.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(models, ModelLibrary(arguments.models).LoadAll());
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const IndexOptions options, ReadIndexOptions(arguments.search, models));
  std::optional<CategorySourceModel> categories;
  if (!arguments.categories.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(categories, ReadCategorySource(arguments.categories));
  }
  return Indexer::Create(std::move(models), options, std::move(categories));
}

// What was searched for in an index, to the end.
class FinishedSearches {
 public:
  [[nodiscard]] static Expected<FinishedSearches> Read(std::span<const ModelRecord> targets, IndexStore& store) {
    FinishedSearches finished;
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ModelRecord> models, store.Models());
    for (const ModelRecord& target : targets) {
      const auto stored = std::ranges::find_if(models, [&](const ModelRecord& model) {
        return model.name == target.name && model.content_id == target.content_id;
      });
      finished.models_.push_back(stored == models.end() ? 0 : stored->id);
    }
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<SearchRecord> searches, store.Searches());
    for (const SearchRecord& search : searches) {
      if (search.finished) finished.searches_.emplace(search.video, search.model);
    }
    return finished;
  }

  /// Whether the video was searched for all targets.
  [[nodiscard]] bool HasAllOf(std::int64_t video) const {
    return std::ranges::all_of(models_, [&](std::int64_t model) { return searches_.contains({video, model}); });
  }

 private:
  std::vector<std::int64_t> models_;  // of the targets; 0: not in the index
  std::set<std::pair<std::int64_t, std::int64_t>> searches_;
};

Status CheckArguments(const SubmitArguments& arguments) {
  if (!IsDatabaseUrl(arguments.db)) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("--db {}: workers share a database: give postgresql://USER@HOST/DATABASE; into a file, "
                            "`victorious index` searches by itself",
                            arguments.db));
  }
  if (arguments.models.empty() && arguments.categories.empty()) {
    return Fail(ErrorCode::kInvalidArgument, "nothing to search for: give --models, --categories, or both");
  }
  return {};
}

struct DescribedVideo {
  VideoRecord record;
  VideoInfo info;  // but for live sources
  bool is_live = false;
  std::vector<ContentFile> files;  // empty if they are not published
};

Expected<std::vector<ContentFile>> Publish(std::span<const fs::path> files, const std::string& place) {
  std::vector<ContentFile> published;
  for (const fs::path& file : files) {
    VICTORIOUS_ASSIGN_OR_RETURN(ContentFile described, DescribeFile(file, Interrupt()));
    VICTORIOUS_RETURN_IF_ERROR(PublishFile(described, place, Interrupt()));
    published.push_back(std::move(described));
  }
  return published;
}

// The video itself, or the images of a folder, and its telemetry if that is a file of its own.
Expected<std::vector<fs::path>> FilesOfVideo(const std::string& video) {
  std::vector<fs::path> files = {video};
  if (std::error_code error; fs::is_directory(video, error)) {
    VICTORIOUS_ASSIGN_OR_RETURN(files, ListImages(video));
  }
  if (auto telemetry = FindTelemetryFile(video)) files.push_back(*std::move(telemetry));
  return files;
}

// A live source is not opened: it may send to another machine. Publishes a video, too, if there is a place.
Expected<DescribedVideo> DescribeVideo(const std::string& video, const std::string& place) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<bool> is_live, IsLiveAddress(video));
  if (is_live.value_or(false))
    return DescribedVideo{.record = {.name = video}, .info = {}, .is_live = true, .files = {}};
  VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, VideoReader::Open(video, {}));
  const VideoInfo& info = reader->info();
  if (info.live) return DescribedVideo{.record = {.name = video}, .info = {}, .is_live = true, .files = {}};
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string content, reader->ContentId(Interrupt(), {}));
  DescribedVideo described{
      .record = {.content_id = content, .name = AbsolutePath(video), .width = info.width, .height = info.height},
      .info = info,
      .is_live = false,
      .files = {}};
  if (place.empty()) return described;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<fs::path> files, FilesOfVideo(described.record.name));
  VICTORIOUS_ASSIGN_OR_RETURN(described.files, Publish(files, place));
  return described;
}

// In the order of the videos. Reads one a processor at a time: a single one does not use a network or an array of disks
// fully.
std::vector<Expected<DescribedVideo>> DescribeVideos(std::span<const std::string> videos, const std::string& place) {
  std::vector<Expected<DescribedVideo>> described(videos.size());
  tbb::parallel_for(std::size_t{0}, videos.size(),
                    [&](std::size_t i) { described[i] = DescribeVideo(videos[i], place); });
  return described;
}

postgres::TaskPriority PriorityOf(const DescribedVideo& video, bool is_urgent) {
  if (video.is_live) return postgres::TaskPriority::kLive;
  return is_urgent ? postgres::TaskPriority::kPerson : postgres::TaskPriority::kBatch;
}

// The times that are covered of a live source are those of one search.
Status CheckLiveSource(const postgres::NewTask& task, const std::string& source, postgres::TaskQueue& queue) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<postgres::TaskRecord> records, queue.ListLasting());
  for (const postgres::TaskRecord& record : records) {
    const Expected<IndexTask> work = FromQueue(record.kind, record.payload);
    if (!work || work->video != source || record.key == task.key) continue;
    return Fail(ErrorCode::kConflict,
                fmt::format("{}: is indexed with other models or options: end that first by `victorious cluster end`",
                            OneLine(source)));
  }
  return {};
}

// What can be submitted is, whatever is wrong with other videos: their errors are warnings, but for the last one, which
// the command ends with.
class LeftOutVideos {
 public:
  void Add(Error error) {
    if (last_) LogWarning("left out: {}", OneLine(last_->message));
    last_ = std::move(error);
  }

  [[nodiscard]] Status ToStatus() const {
    if (last_) return std::unexpected(*last_);
    return {};
  }

 private:
  std::optional<Error> last_;
};

// What all tasks of a submission have.
struct SharedPart {
  std::string program;
  std::string targets;                             // their content
  std::map<std::string, std::string> content_ids;  // of the targets by name
  std::vector<ContentFile> files;                  // of the targets, if they are published
};

Expected<SharedPart> MakeSharedPart(const SubmitArguments& arguments, const std::vector<fs::path>& target_files,
                                    const Indexer& indexer) {
  SharedPart shared;
  VICTORIOUS_ASSIGN_OR_RETURN(shared.program, ProgramId());
  VICTORIOUS_ASSIGN_OR_RETURN(shared.targets, ContentIdOfFiles(target_files, Interrupt()));
  for (const ModelRecord& target : indexer.targets()) shared.content_ids.emplace(target.name, target.content_id);
  if (arguments.publish.empty()) return shared;
  VICTORIOUS_ASSIGN_OR_RETURN(shared.files, Publish(target_files, arguments.publish));
  return shared;
}

Expected<postgres::NewTask> MakeTask(const DescribedVideo& video, const SharedPart& shared,
                                     const SubmitArguments& arguments) {
  IndexTask task{.video = video.record.name,
                 .options = IndexOptionsOf(arguments),
                 .program = shared.program,
                 .targets = shared.content_ids,
                 .content_id = video.record.content_id,
                 .files = video.files,
                 .segment_s = video.is_live ? 0 : arguments.segment_s,
                 .is_live = video.is_live,
                 .redo_other = arguments.redo};
  task.files.insert(task.files.end(), shared.files.begin(), shared.files.end());
  const std::string content = video.is_live ? task.video : task.content_id;
  return ToQueue(task, fmt::format("{} {}", content, shared.targets), PriorityOf(video, arguments.urgent));
}

// How a task searches: its options without what it searches for.
std::vector<std::string> HowOf(const std::vector<std::string>& options) {
  std::vector<std::string> how;
  for (std::size_t i = 0; i < options.size(); ++i) {
    if (options[i] == "--models" || options[i] == "--categories") {
      ++i;  // and its value
    } else {
      how.push_back(options[i]);
    }
  }
  return how;
}

// The options of the tasks that are open, by the content of their video: its results would be those of one of them, and
// the others would fail.
Expected<std::multimap<std::string, std::vector<std::string>>> OptionsOfOpenTasks(
    const std::vector<DescribedVideo>& videos, postgres::TaskQueue& queue) {
  std::vector<std::string> contents;
  for (const DescribedVideo& video : videos) {
    if (!video.is_live) contents.push_back(video.record.content_id);
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<postgres::TaskRecord> open, queue.FindOpen(kIndexTaskKind, contents));
  std::multimap<std::string, std::vector<std::string>> options;
  for (const postgres::TaskRecord& record : open) {
    const Expected<IndexTask> task = FromQueue(record.kind, record.payload);
    if (task) options.emplace(task->content_id, HowOf(task->options));
  }
  return options;
}

Status CheckOpenTasks(const DescribedVideo& video, const SubmitArguments& arguments,
                      const std::multimap<std::string, std::vector<std::string>>& open) {
  const std::vector<std::string> wanted = HowOf(IndexOptionsOf(arguments));
  const auto [first, last] = open.equal_range(video.record.content_id);
  for (auto one = first; one != last; ++one) {
    if (one->second == wanted) continue;
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: is queued with other options ({}): wait until it is done, or give the same",
                            OneLine(video.record.name),
                            one->second.empty() ? "none" : OneLine(fmt::format("{}", fmt::join(one->second, " ")))));
  }
  return {};
}

// Stores the video, and returns whether anything is left to be done with it.
Expected<bool> PutUndone(const DescribedVideo& video, const Indexer& indexer, Redo redo,
                         const FinishedSearches& finished, IndexStore& store) {
  if (video.is_live) return true;
  // A worker would refuse what is refused here.
  VICTORIOUS_ASSIGN_OR_RETURN(const bool is_redone, indexer.IsRedone({.video = video.record.name, .redo = redo},
                                                                     video.info, video.record.content_id, store));
  VICTORIOUS_ASSIGN_OR_RETURN(const VideoRecord stored, store.PutVideo(video.record));
  return is_redone || !finished.HasAllOf(stored.id);
}

// Whether frames of the video were left out of a search.
Expected<bool> HasGaps(const DescribedVideo& video, IndexStore& store) {
  if (video.is_live) return false;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<VideoRecord> stored, store.VideoOfContent(video.record.content_id));
  if (!stored) return false;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<SearchPart> parts, store.SearchParts(stored->id));
  return std::ranges::find(parts, SearchPartKind::kFailed, &SearchPart::kind) != parts.end();
}

Status Run(const SubmitArguments& arguments) {
  VICTORIOUS_RETURN_IF_ERROR(CheckArguments(arguments));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<fs::path> target_files, FilesOfTargets(arguments));
  VICTORIOUS_ASSIGN_OR_RETURN(const Indexer indexer, MakeIndexer(arguments));
  VICTORIOUS_ASSIGN_OR_RETURN(const SharedPart shared, MakeSharedPart(arguments, target_files, indexer));
  std::vector<DescribedVideo> videos;
  LeftOutVideos left_out;
  for (Expected<DescribedVideo>& described : DescribeVideos(arguments.videos, arguments.publish)) {
    if (described) {
      videos.push_back(*std::move(described));
    } else if (described.error().code == ErrorCode::kCancelled) {
      return std::unexpected(described.error());
    } else {
      left_out.Add(std::move(described).error());
    }
  }
  if (videos.empty()) return left_out.ToStatus();
  VICTORIOUS_ASSIGN_OR_RETURN(const std::unique_ptr<IndexStore> store, OpenStore(arguments.db, StoreMode::kCreate));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto queue,
                              postgres::TaskQueue::Open(arguments.db, {.worker = "submit", .program = shared.program}));
  VICTORIOUS_ASSIGN_OR_RETURN(const FinishedSearches finished, FinishedSearches::Read(indexer.targets(), *store));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto open, OptionsOfOpenTasks(videos, *queue));
  const Redo redo = arguments.redo ? Redo::kIfDifferent : Redo::kNever;
  std::vector<postgres::NewTask> tasks;
  std::int64_t live = 0;
  std::int64_t with_gaps = 0;  // that are not searched again
  // In the order given, which is that of the results, whichever worker is first.
  for (const DescribedVideo& video : videos) {
    VICTORIOUS_ASSIGN_OR_RETURN(postgres::NewTask task, MakeTask(video, shared, arguments));
    if (video.is_live) VICTORIOUS_RETURN_IF_ERROR(CheckLiveSource(task, video.record.name, *queue));
    const Status is_consistent = video.is_live ? Status() : CheckOpenTasks(video, arguments, open);
    const Expected<bool> is_undone =
        is_consistent ? PutUndone(video, indexer, redo, finished, *store) : std::unexpected(is_consistent.error());
    if (!is_undone && is_undone.error().code != ErrorCode::kInvalidArgument) return std::unexpected(is_undone.error());
    if (!is_undone) {
      left_out.Add(is_undone.error());
      continue;
    }
    task.is_undone = *is_undone;
    live += video.is_live ? 1 : 0;
    VICTORIOUS_ASSIGN_OR_RETURN(const bool has_gaps, HasGaps(video, *store));
    with_gaps += has_gaps && !task.is_undone ? 1 : 0;
    tasks.push_back(std::move(task));
  }
  if (tasks.empty()) return left_out.ToStatus();
  VICTORIOUS_ASSIGN_OR_RETURN(const postgres::Submission submission, queue->Submit(tasks));
  VICTORIOUS_ASSIGN_OR_RETURN(const postgres::TaskCounts counts, queue->Count());
  // The same video given twice is one task.
  const std::int64_t before = std::max<std::int64_t>(0, std::ssize(tasks) - submission.added - submission.done);
  LogInfo("{} submitted{}{}{}; {} queued, {} running", CountText(submission.added, "video"),
          live > 0 ? fmt::format(", with {}", CountText(live, "live source")) : "",
          before > 0 ? fmt::format(", {} submitted before", before) : "",
          submission.done > 0 ? fmt::format(", {} done already", submission.done) : "", counts.queued, counts.running);
  if (with_gaps > 0) {
    LogWarning("{} done already, with frames left out (`victorious cluster status` lists them): --redo searches again",
               CountText(with_gaps, "video"));
  }
  if (arguments.json) {
    const nlohmann::ordered_json line = {{"submitted", submission.added},
                                         {"submitted_before", before},
                                         {"done", submission.done},
                                         {"queued", counts.queued},
                                         {"running", counts.running}};
    VICTORIOUS_RETURN_IF_ERROR(WriteOutput("", DumpJson(line) + "\n"));
  }
  return left_out.ToStatus();
}

}  // namespace

Action SetUpSubmit(ArgumentParser& parser) {
  const auto arguments = std::make_shared<SubmitArguments>();
  parser
      .Add("VIDEO", arguments->videos,
           "Files or folders of frames, at the same path on all machines unless --publish; or URLs of live sources, "
           "which are indexed until `victorious cluster end`")
      .Required();
  parser.Add("--models", arguments->models, "Folder of models to search for").TypeName("DIR");
  parser.Add("--categories", arguments->categories, "A category model or an imported detector, searched for as well")
      .TypeName("FILE");
  parser.Add("--db", arguments->db, "The index: postgresql://USER@HOST/DATABASE").Required().TypeName("URL");
  AddSearchSettings(parser, arguments->search);
  parser
      .Add("--publish", arguments->publish,
           "Put the videos, models and categories also here, by their content: workers fetch what they do not have "
           "from it (`victorious work --content`)")
      .TypeName("DIR");
  parser
      .Add("--segment", arguments->segment_s,
           "Seconds of video that a worker takes at a time, so that several index one video; 0: whole videos")
      .ShowDefault()
      .Range(0.0, 86'400.0)
      .TypeName("SECONDS");
  parser.AddFlag("--redo", arguments->redo,
                 "Delete results of these models and categories that were made with other parameters, or with frames "
                 "left out that killed their process, and search those videos again");
  parser.AddFlag("--urgent", arguments->urgent, "Before what was submitted without this flag");
  parser.AddFlag("--json", arguments->json,
                 "Print one JSON object: the videos submitted now, before and done already, and the tasks of all");
  return [=] { return Run(*arguments); };
}

}  // namespace victorious::cli

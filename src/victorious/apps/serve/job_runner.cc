#include "victorious/apps/serve/job_runner.h"

#include <algorithm>
#include <span>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "victorious/apps/serve/job_body.h"
#include "victorious/base/absolute_path.h"
#include "victorious/base/file.h"
#include "victorious/base/folder.h"
#include "victorious/base/json.h"
#include "victorious/base/lease_clock.h"
#include "victorious/base/log.h"
#include "victorious/base/utc.h"

namespace victorious {
namespace {

std::int64_t Microseconds(std::chrono::milliseconds duration) {
  return std::chrono::duration_cast<std::chrono::microseconds>(duration).count();
}

// Whether an argument of a process can be this value: a zero byte would cut it off.
bool IsArgument(const nlohmann::json& value) {
  return value.is_string() && !value.get<std::string>().empty() &&
         value.get<std::string>().find('\0') == std::string::npos;
}

Expected<std::string> TextMember(const nlohmann::json& input, const char* name) {
  const auto found = input.find(name);
  if (found != input.end() && IsArgument(*found)) return found->get<std::string>();
  return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: must be a text without zero bytes", name));
}

// The path of a file that the job reads.
Expected<std::string> SourceMember(const nlohmann::json& input, const char* name, const JobFolders& folders) {
  VICTORIOUS_ASSIGN_OR_RETURN(std::string path, TextMember(input, name));
  VICTORIOUS_RETURN_IF_ERROR(folders.files.Check(path));
  return path;
}

// The path of the file that the job makes.
Expected<std::string> MadeMember(const nlohmann::json& input, const char* name, const JobFolders& folders) {
  VICTORIOUS_ASSIGN_OR_RETURN(std::string text, TextMember(input, name));
  const std::filesystem::path path = text;
  const bool has_name = path.has_filename() && path.filename().native().front() != '.';
  if (has_name && AbsolutePath(path.parent_path()) == AbsolutePath(folders.copies)) return text;
  return Fail(ErrorCode::kInvalidArgument,
              fmt::format("{}: must lie in the folder of copies of this server: ask for it anew", name));
}

// Tells a command that reads paths out of the index which of these it may open.
void AddFilesBelow(const JobFolders& folders, std::vector<std::string>& arguments) {
  for (const std::filesystem::path& root : folders.files.roots()) {
    arguments.push_back("--files-below=" + root.string());
  }
}

// Appends FLAG=NUMBER with the number that the input has under a name, if it has one.
Status AddNumber(const nlohmann::json& input, const char* name, const char* flag, std::vector<std::string>& arguments) {
  const auto found = input.find(name);
  if (found == input.end() || found->is_null()) return {};
  if (!found->is_number()) return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: must be a number", name));
  arguments.push_back(fmt::format("{}={}", flag, found->get<double>()));
  return {};
}

// The flag of a box.
Expected<std::string> BoxFlag(const nlohmann::json& box) {
  const bool is_box = box.is_array() && box.size() == 4 &&
                      std::ranges::all_of(box, [](const nlohmann::json& one) { return one.is_number(); });
  if (!is_box) return Fail(ErrorCode::kInvalidArgument, "box: must be four numbers");
  return fmt::format("--box={},{},{},{}", box[0].get<double>(), box[1].get<double>(), box[2].get<double>(),
                     box[3].get<double>());
}

// Appends --telemetry=FILE, if the input has one.
Status AddTelemetry(const nlohmann::json& input, const JobFolders& folders, std::vector<std::string>& arguments) {
  const auto found = input.find("telemetry");
  if (found == input.end() || found->is_null()) return {};
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string telemetry, SourceMember(input, "telemetry", folders));
  arguments.push_back("--telemetry=" + telemetry);
  return {};
}

Expected<std::vector<std::string>> ClipArguments(const nlohmann::json& input, const JobFolders& folders) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string video, TextMember(input, "video"));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string clip, MadeMember(input, "clip", folders));
  const auto object = input.find("object");
  if (object == input.end() || !object->is_number_integer()) {
    return Fail(ErrorCode::kInvalidArgument, "object: must be the number of an object");
  }
  std::vector<std::string> arguments = {"export",      "--format",
                                        "video",       "--db",
                                        folders.index, "--video=" + video,
                                        "--object",    std::to_string(object->get<std::int64_t>()),
                                        "--clip",      "2"};
  VICTORIOUS_RETURN_IF_ERROR(AddNumber(input, "from_s", "--from", arguments));
  VICTORIOUS_RETURN_IF_ERROR(AddNumber(input, "to_s", "--to", arguments));
  VICTORIOUS_RETURN_IF_ERROR(AddTelemetry(input, folders, arguments));
  AddFilesBelow(folders, arguments);
  arguments.insert(arguments.end(), {"--force", "--out", clip});
  return arguments;
}

// In these, "--" ends the options and "=" binds a value to its flag, so that a name may begin with a dash.

Expected<std::vector<std::string>> IndexArguments(JobKind kind, const nlohmann::json& input,
                                                  const JobFolders& folders) {
  std::string video;
  if (kind == JobKind::kLive) {
    VICTORIOUS_ASSIGN_OR_RETURN(video, TextMember(input, "video"));
    if (!IsLiveSource(video)) return Fail(ErrorCode::kInvalidArgument, "video: must be the address of a live source");
  } else {
    VICTORIOUS_ASSIGN_OR_RETURN(video, SourceMember(input, "video", folders));
  }
  std::vector<std::string> arguments = {"index", "--models", folders.models.string(), "--db", folders.index};
  if (!folders.categories.empty()) arguments.push_back("--categories=" + folders.categories.string());
  VICTORIOUS_RETURN_IF_ERROR(AddTelemetry(input, folders, arguments));
  AddFilesBelow(folders, arguments);
  if (!folders.certificates.empty()) arguments.push_back("--ca=" + folders.certificates.string());
  if (kind == JobKind::kIndex && input.value("redo", nlohmann::json()) == true) arguments.emplace_back("--redo");
  arguments.insert(arguments.end(), {"--", video});
  return arguments;
}

Expected<std::vector<std::string>> ModelArguments(const nlohmann::json& input, const JobFolders& folders) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string name, TextMember(input, "name"));
  std::vector<std::string> arguments = {"model", "add", "--models", folders.models.string()};
  VICTORIOUS_RETURN_IF_ERROR(AddNumber(input, "length_m", "--length", arguments));
  if (const auto box = input.find("box"); box != input.end() && !box->is_null()) {
    VICTORIOUS_ASSIGN_OR_RETURN(std::string flag, BoxFlag(*box));
    arguments.push_back(std::move(flag));
  }
  if (const auto boxes = input.find("boxes"); boxes != input.end()) {
    if (!boxes->is_array()) return Fail(ErrorCode::kInvalidArgument, "boxes: must be a list");
    for (const nlohmann::json& box : *boxes) {
      VICTORIOUS_ASSIGN_OR_RETURN(std::string flag, BoxFlag(box));
      arguments.push_back(std::move(flag));
    }
  }
  arguments.insert(arguments.end(), {"--", name});
  const auto files = input.find("files");
  if (files == input.end() || !files->is_array() || files->empty()) {
    return Fail(ErrorCode::kInvalidArgument, "files: must be a list of paths");
  }
  for (const nlohmann::json& file : *files) {
    if (!IsArgument(file)) return Fail(ErrorCode::kInvalidArgument, "files: must be a list of paths");
    const bool is_sample = !folders.sample_object.empty() && file.get<std::string>() == folders.sample_object;
    if (!is_sample) VICTORIOUS_RETURN_IF_ERROR(folders.files.Check(file.get<std::string>()));
    arguments.push_back(file.get<std::string>());
  }
  return arguments;
}

Expected<std::vector<std::string>> CopyArguments(const nlohmann::json& input, const JobFolders& folders) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string video, SourceMember(input, "video", folders));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string copy, MadeMember(input, "copy", folders));
  return std::vector<std::string>{"copy", "--force", "--out", copy, "--", video};
}

Expected<std::vector<std::string>> TrackArguments(const nlohmann::json& input, const JobFolders& folders) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string video, SourceMember(input, "video", folders));
  VICTORIOUS_ASSIGN_OR_RETURN(std::string box, BoxFlag(input.value("box", nlohmann::json())));
  std::vector<std::string> arguments = {"track", "--db", folders.index, std::move(box)};
  const auto at = input.find("at_s");
  if (at == input.end() || !at->is_number()) return Fail(ErrorCode::kInvalidArgument, "at_s: must be a number");
  arguments.push_back(fmt::format("--at={:.6f}", at->get<double>()));
  if (const auto type = input.find("type"); type != input.end() && !type->is_null()) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::string word, TextMember(input, "type"));
    arguments.push_back("--type=" + word);
  }
  VICTORIOUS_RETURN_IF_ERROR(AddTelemetry(input, folders, arguments));
  arguments.insert(arguments.end(), {"--", video});
  return arguments;
}

Expected<std::vector<std::string>> RefineArguments(const nlohmann::json& input, const JobFolders& folders) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string categories, TextMember(input, "categories"));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string refined, MadeMember(input, "refine", folders));
  if (categories != folders.categories) {
    return Fail(ErrorCode::kInvalidArgument, "categories: must be the category model of this server");
  }
  std::vector<std::string> arguments = {"category", "refine", "--model=" + categories, "--db=" + folders.index};
  AddFilesBelow(folders, arguments);
  arguments.insert(arguments.end(), {"--force", "--out=" + refined});
  return arguments;
}

// A second attempt goes on from nothing: --force.
Expected<std::vector<std::string>> SampleArguments(const nlohmann::json& input, const JobFolders& folders) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string scene, TextMember(input, "scene"));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string folder, TextMember(input, "folder"));
  if (folders.sample_scene.empty() || scene != folders.sample_scene) {
    return Fail(ErrorCode::kInvalidArgument, "scene: must be that of the sample of this server");
  }
  const std::filesystem::path made = folder;
  const bool has_name = made.has_filename() && made.filename().native().front() != '.';
  if (!has_name || AbsolutePath(made.parent_path()) != AbsolutePath(folders.uploads)) {
    return Fail(ErrorCode::kInvalidArgument, "folder: must lie in the folder of uploads of this server");
  }
  return std::vector<std::string>{"simulate", "--force", "--out=" + folder, "--", scene};
}

Expected<std::vector<std::string>> RemoveArguments(const nlohmann::json& input, const JobFolders& folders) {
  const bool is_video = input.contains("video");
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string name, TextMember(input, is_video ? "video" : "model"));
  if (is_video) return std::vector<std::string>{"remove", "--db", folders.index, "--video=" + name};
  return std::vector<std::string>{"remove",         "--db", folders.index, "--models", folders.models.string(),
                                  "--model=" + name};
}

}  // namespace

Expected<std::vector<std::string>> JobArguments(const JobRecord& job, const JobFolders& folders) {
  VICTORIOUS_ASSIGN_OR_RETURN(const nlohmann::json input, ParseJson(job.input_json));
  if (!input.is_object()) return Fail(ErrorCode::kInvalidArgument, "the input must be an object");
  switch (job.kind) {
    case JobKind::kIndex:
    case JobKind::kLive:
      return IndexArguments(job.kind, input, folders);
    case JobKind::kModel:
      return ModelArguments(input, folders);
    case JobKind::kCopy:
      return CopyArguments(input, folders);
    case JobKind::kTrack:
      return TrackArguments(input, folders);
    case JobKind::kRefine:
      return RefineArguments(input, folders);
    case JobKind::kSample:
      return SampleArguments(input, folders);
    case JobKind::kRemove:
      return RemoveArguments(input, folders);
    case JobKind::kClip:
      break;
  }
  return ClipArguments(input, folders);
}

std::string RefinedPrefix(const std::string& index) {
  return fmt::format("categories-{:016x}-", Checksum(std::as_bytes(std::span(index))));
}

std::optional<std::filesystem::path> MadeFileOf(const JobRecord& job) {
  if (!MakesFile(job.kind)) return std::nullopt;
  const auto input = ParseJson(job.input_json);
  if (!input || !input->is_object()) return std::nullopt;
  const auto path = TextMember(*input, std::string(ToText(job.kind)).c_str());
  return path ? std::optional<std::filesystem::path>(*path) : std::nullopt;
}

void RemoveUnfinishedCopies(const std::filesystem::path& copy) {
  const std::string prefix = copy.filename().string() + ".tmp-";
  const auto paths = ListFolder(copy.parent_path());
  if (!paths) LogWarning("{}", paths.error().message);
  for (const std::filesystem::path& path : paths.value_or(std::vector<std::filesystem::path>())) {
    if (!path.filename().string().starts_with(prefix)) continue;
    std::error_code error;
    if (!std::filesystem::remove(path, error) && error) LogWarning("remove {}: {}", path.string(), error.message());
  }
}

bool ApplyEvent(const ProgramEvent& event, JobProgress& progress) {
  if (const auto* const step = std::get_if<ProgressEvent>(&event)) {
    progress.done = step->done;
    progress.total = step->total;
    progress.unit = step->unit;
    progress.behind_s = step->behind_s;
  } else if (const auto* const info = std::get_if<InfoEvent>(&event)) {
    progress.message = info->message;
  } else if (const auto* const warning = std::get_if<WarningEvent>(&event)) {
    progress.message = warning->message;
  } else if (const auto* const failure = std::get_if<ErrorEvent>(&event)) {
    progress.message = failure->error.message;
  } else {
    return false;
  }
  return true;
}

JobRunner::JobRunner(std::unique_ptr<JobQueue> queue, JobFolders folders, std::function<void()> on_change,
                     Options options)
    : queue_(std::move(queue)),
      folders_(std::move(folders)),
      on_change_(std::move(on_change)),
      options_(std::move(options)),
      worker_name_(fmt::format("{}.{}.{}", ::getpid(), NowUtcMicroseconds(), static_cast<const void*>(this))),
      thread_([this] { Run(); }) {}

JobRunner::~JobRunner() {
  BeginToEnd();
  thread_.join();
}

void JobRunner::BeginToEnd() {
  is_ending_ = true;
  Wake();
}

void JobRunner::Wake() {
  const std::scoped_lock lock(mutex_);
  is_woken_ = true;
  woken_.notify_one();
}

void JobRunner::WaitForWork() {
  std::unique_lock lock(mutex_);
  woken_.wait_for(lock, options_.poll, [this] { return is_woken_; });
  is_woken_ = false;
}

void JobRunner::Run() {
  std::string failure;  // the last one, until there is none
  while (!is_ending_) {
    const auto claimed = LeaseClock::Clock::now();
    const auto job = queue_->Claim(worker_name_, options_.kinds, NowUtcMicroseconds(), Microseconds(options_.lease));
    const std::string message = job ? "" : job.error().message;
    // Once for all failures in a row.
    if (message != failure && !message.empty()) LogWarning("the queue of jobs: {}", message);
    failure = message;
    if (!job || !*job) {
      WaitForWork();
      continue;
    }
    on_change_();
    Work(**job, claimed);
    on_change_();
  }
}

void JobRunner::Work(const JobRecord& job, std::chrono::steady_clock::time_point claimed) {
  const auto report = [&](const Status& ended) {
    if (!ended) LogWarning("job {}: {}", job.id, ended.error().message);
  };
  const auto complete = [&](const std::string& message) {
    report(queue_->Complete(job.id, worker_name_, message, NowUtcMicroseconds()));
  };
  const auto fail = [&](const std::string& message) {
    report(queue_->Fail(job.id, worker_name_, message, NowUtcMicroseconds()));
  };
  const auto arguments = JobArguments(job, folders_);
  if (!arguments) return fail(arguments.error().message);
  if (const auto made = MakesFile(job.kind) ? MadeFileOf(job) : std::nullopt) {
    std::error_code error;
    // The file exists where a second user asked for it just after the first one's job ended.
    if (std::filesystem::is_regular_file(*made, error)) return complete("");
    RemoveUnfinishedCopies(*made);
  }
  JobProgress progress;
  bool is_new = false;
  bool is_cancelled = false;
  bool is_released = false;
  LeaseClock lease(options_.lease, options_.renewal, claimed);
  const auto control = [&] {
    if (const auto now = LeaseClock::Clock::now(); lease.IsDue(now) || is_new) {
      const auto goes_on =
          queue_->Renew(job.id, worker_name_, NowUtcMicroseconds(), Microseconds(options_.lease), progress);
      lease.Enter(goes_on ? Status() : std::unexpected(goes_on.error()), now);
      is_cancelled |= goes_on && !*goes_on;
      if (std::exchange(is_new, false)) on_change_();
    }
    if (lease.IsLost(LeaseClock::Clock::now())) return ChildControl::kKill;
    is_released |= is_ending_;
    return is_cancelled || is_released ? ChildControl::kInterrupt : ChildControl::kContinue;
  };
  const auto read = [&](const ProgramEvent& event) { is_new |= ApplyEvent(event, progress); };
  const auto end = RunChild({.command = options_.command(*arguments), .on_event = read, .control = control});
  if (!end) return fail(end.error().message);
  if (lease.was_lost()) {
    LogWarning("job {}: its lease was lost: left to another server", job.id);
    return;
  }
  // An interrupted search of a live source ends well, but goes on with the next server.
  if (is_released && !is_cancelled && job.kind == JobKind::kLive) return report(queue_->Release(job.id, worker_name_));
  if (end->status == 0) return complete(progress.message);
  if (is_cancelled) return report(queue_->EndCancelled(job.id, worker_name_, NowUtcMicroseconds()));
  if (is_released) return report(queue_->Release(job.id, worker_name_));
  fail(DescribeFailure(*end));
}

}  // namespace victorious

#include "victorious/serve/job_runner.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "victorious/base/child_process.h"
#include "victorious/base/json.h"
#include "victorious/base/utc.h"

namespace victorious {
namespace {

using Json = nlohmann::json;

std::int64_t Microseconds(std::chrono::milliseconds duration) {
  return std::chrono::duration_cast<std::chrono::microseconds>(duration).count();
}

Expected<std::string> TextMember(const Json& input, const char* name) {
  const auto found = input.find(name);
  if (found != input.end() && found->is_string() && !found->get<std::string>().empty()) {
    return found->get<std::string>();
  }
  return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: must be a text", name));
}

// Appends FLAG and the number that the input has under a name, if it has one.
Status AddNumber(const Json& input, const char* name, const char* flag, std::vector<std::string>& arguments) {
  const auto found = input.find(name);
  if (found == input.end() || found->is_null()) return {};
  if (!found->is_number()) return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: must be a number", name));
  arguments.insert(arguments.end(), {flag, fmt::format("{}", found->get<double>())});
  return {};
}

Expected<std::vector<std::string>> ClipArguments(const Json& input, const JobFolders& folders) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string video, TextMember(input, "video"));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string clip, TextMember(input, "clip"));
  const auto object = input.find("object");
  if (object == input.end() || !object->is_number_integer()) {
    return Fail(ErrorCode::kInvalidArgument, "object: must be the number of an object");
  }
  // With "=", the name of a video that begins with a dash is no flag.
  std::vector<std::string> arguments = {"export",
                                        "--format",
                                        "video",
                                        "--db",
                                        folders.index.string(),
                                        "--video=" + video,
                                        "--object",
                                        std::to_string(object->get<std::int64_t>()),
                                        "--clip",
                                        "2"};
  VICTORIOUS_RETURN_IF_ERROR(AddNumber(input, "from_s", "--from", arguments));
  VICTORIOUS_RETURN_IF_ERROR(AddNumber(input, "to_s", "--to", arguments));
  if (input.contains("telemetry") && !input["telemetry"].is_null()) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::string telemetry, TextMember(input, "telemetry"));
    arguments.push_back("--telemetry=" + telemetry);
  }
  arguments.insert(arguments.end(), {"--force", "--out", clip});
  return arguments;
}

// Takes a number from the beginning of a text.
std::optional<std::int64_t> TakeNumber(std::string_view& text) {
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || number < 0) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return number;
}

bool TakePrefix(std::string_view& text, std::string_view prefix) {
  if (!text.starts_with(prefix)) return false;
  text.remove_prefix(prefix.size());
  return true;
}

}  // namespace

Expected<std::vector<std::string>> JobArguments(const JobRecord& job, const JobFolders& folders) {
  VICTORIOUS_ASSIGN_OR_RETURN(const Json input, ParseJson(job.input_json));
  if (!input.is_object()) return Fail(ErrorCode::kInvalidArgument, "the input must be an object");
  // "--" ends the options: the name of a file that begins with a dash is none.
  if (job.kind == "index") {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::string video, TextMember(input, "video"));
    std::vector<std::string> arguments = {"index", "--models", folders.models.string(), "--db", folders.index.string()};
    if (input.contains("telemetry") && !input["telemetry"].is_null()) {
      VICTORIOUS_ASSIGN_OR_RETURN(const std::string telemetry, TextMember(input, "telemetry"));
      arguments.insert(arguments.end(), {"--telemetry", telemetry});
    }
    arguments.insert(arguments.end(), {"--", video});
    return arguments;
  }
  if (job.kind == "model") {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::string name, TextMember(input, "name"));
    std::vector<std::string> arguments = {"model", "add", "--models", folders.models.string()};
    VICTORIOUS_RETURN_IF_ERROR(AddNumber(input, "length_m", "--length", arguments));
    if (const auto box = input.find("box"); box != input.end() && !box->is_null()) {
      const bool is_box = box->is_array() && box->size() == 4 &&
                          std::ranges::all_of(*box, [](const Json& one) { return one.is_number(); });
      if (!is_box) return Fail(ErrorCode::kInvalidArgument, "box: must be four numbers");
      arguments.push_back(fmt::format("--box={},{},{},{}", (*box)[0].get<double>(), (*box)[1].get<double>(),
                                      (*box)[2].get<double>(), (*box)[3].get<double>()));
    }
    arguments.insert(arguments.end(), {"--", name});
    const auto files = input.find("files");
    if (files == input.end() || !files->is_array() || files->empty()) {
      return Fail(ErrorCode::kInvalidArgument, "files: must be a list of paths");
    }
    for (const Json& file : *files) {
      if (!file.is_string()) return Fail(ErrorCode::kInvalidArgument, "files: must be a list of paths");
      arguments.push_back(file.get<std::string>());
    }
    return arguments;
  }
  if (job.kind == "copy") {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::string video, TextMember(input, "video"));
    VICTORIOUS_ASSIGN_OR_RETURN(const std::string copy, TextMember(input, "copy"));
    return std::vector<std::string>{"copy", "--force", "--out", copy, "--", video};
  }
  if (job.kind == "clip") return ClipArguments(input, folders);
  return Fail(ErrorCode::kInvalidArgument, fmt::format("kind \"{}\": must be index, model, copy or clip", job.kind));
}

std::optional<std::filesystem::path> MadeFileOf(const JobRecord& job) {
  if (job.kind != "copy" && job.kind != "clip") return std::nullopt;
  const auto input = ParseJson(job.input_json);
  if (!input || !input->is_object()) return std::nullopt;
  const auto path = TextMember(*input, job.kind.c_str());
  return path ? std::optional<std::filesystem::path>(*path) : std::nullopt;
}

void RemoveUnfinishedCopies(const std::filesystem::path& copy) {
  const std::string prefix = copy.filename().string() + ".tmp-";
  std::vector<std::filesystem::path> found;
  std::error_code error;
  for (std::filesystem::directory_iterator at(copy.parent_path(), error), end; !error && at != end;
       at.increment(error)) {
    if (at->path().filename().string().starts_with(prefix)) found.push_back(at->path());
  }
  if (error) spdlog::warn("{}: {}", copy.parent_path().string(), error.message());
  for (const std::filesystem::path& path : found) {
    if (!std::filesystem::remove(path, error) && error) spdlog::warn("remove {}: {}", path.string(), error.message());
  }
}

bool ReadProgressLine(std::string_view line, JobProgress& progress) {
  // "LABEL: 12 of 40 frames, 3.5 a second": the label may hold colons itself.
  for (std::size_t colon = line.rfind(": "); colon != std::string_view::npos && line.ends_with(" a second");
       colon = colon == 0 ? std::string_view::npos : line.rfind(": ", colon - 1)) {
    std::string_view rest = line.substr(colon + 2);
    const auto done = TakeNumber(rest);
    const bool has_total = done && TakePrefix(rest, " of ");
    const std::optional<std::int64_t> total = has_total ? TakeNumber(rest) : std::nullopt;
    if (!done || has_total != total.has_value() || !TakePrefix(rest, " ")) continue;
    const std::string_view unit = rest.substr(0, rest.find(','));
    progress.done = *done;
    progress.total = total;
    progress.unit = unit;
    return true;
  }
  for (const std::string_view prefix : {"error: ", "warning: ", "info: "}) {
    if (!line.starts_with(prefix)) continue;
    progress.message = line.substr(prefix.size());
    return true;
  }
  return false;
}

JobRunner::JobRunner(std::unique_ptr<JobQueue> queue, JobFolders folders, std::function<void()> on_change,
                     Options options)
    : queue_(std::move(queue)),
      folders_(std::move(folders)),
      on_change_(std::move(on_change)),
      options_(options),
      owner_(fmt::format("{}.{}", ::getpid(), NowUtcMicroseconds())),
      thread_([this] { Run(); }) {}

JobRunner::~JobRunner() {
  is_ending_ = true;
  Wake();
  thread_.join();
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
  while (!is_ending_) {
    const auto job = queue_->Claim(owner_, NowUtcMicroseconds(), Microseconds(options_.lease));
    if (!job) spdlog::warn("the queue of jobs: {}", job.error().message);
    if (!job || !*job) {
      WaitForWork();
      continue;
    }
    on_change_();
    Work(**job);
    on_change_();
  }
}

void JobRunner::Work(const JobRecord& job) {
  const auto finish = [&](JobState state, const std::string& message) {
    const Status status = queue_->Finish(job.id, owner_, state, message, NowUtcMicroseconds());
    if (!status) spdlog::warn("job {}: {}", job.id, status.error().message);
  };
  const auto arguments = JobArguments(job, folders_);
  if (!arguments) return finish(JobState::kFailed, arguments.error().message);
  if (const auto made = MadeFileOf(job)) {
    std::error_code error;
    // Two asked for it, the second when the job of the first had just ended.
    if (std::filesystem::is_regular_file(*made, error)) return finish(JobState::kDone, "");
    RemoveUnfinishedCopies(*made);
  }
  auto child = ChildProcess::StartSelf(*arguments);
  if (!child) return finish(JobState::kFailed, child.error().message);
  JobProgress progress;
  std::string error;
  bool is_cancelled = false;
  bool is_released = false;
  std::optional<std::chrono::steady_clock::time_point> beaten;
  while (!child->has_ended()) {
    bool is_new = false;
    for (const std::string& line : child->ReadLines(std::chrono::milliseconds(200))) {
      is_new |= ReadProgressLine(line, progress);
      if (line.starts_with("error: ")) error = line.substr(7);
    }
    if (is_ending_ && !is_released) {
      is_released = true;
      child->Interrupt();
    }
    const auto now = std::chrono::steady_clock::now();
    if (beaten && now - *beaten < options_.heartbeat && !is_new) continue;
    beaten = now;
    const auto goes_on = queue_->Beat(job.id, owner_, NowUtcMicroseconds(), Microseconds(options_.lease), progress);
    // Another worker has it: two must not write the same results.
    if (!goes_on && goes_on.error().code == ErrorCode::kConflict) return;
    if (goes_on && !*goes_on && !is_cancelled) {
      is_cancelled = true;
      child->Interrupt();
    }
    if (is_new) on_change_();
  }
  const int status = child->Wait();
  if (status == 0) return finish(JobState::kDone, progress.message);
  if (is_cancelled) return finish(JobState::kCancelled, "");
  if (is_released) {
    const Status released = queue_->Release(job.id, owner_);
    if (!released) spdlog::warn("job {}: {}", job.id, released.error().message);
    return;
  }
  if (error.empty()) error = DescribeFailure(status);
  finish(JobState::kFailed, error);
}

}  // namespace victorious

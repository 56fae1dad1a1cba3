#include "victorious/apps/cluster/worker.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <csignal>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "victorious/base/child_task.h"
#include "victorious/base/count_text.h"
#include "victorious/base/lease_clock.h"

namespace victorious {
namespace {

using postgres::Task;
using postgres::TaskQueue;

constexpr std::chrono::milliseconds kCancelPoll{200};
constexpr int kSignalStatus = 128;      // and the number of the signal that killed a process
constexpr double kShorterSegments = 8;  // at the last attempt of a video
constexpr double kLastSegment_s = 7.5;  // the same of one that was not to be cut
constexpr std::chrono::milliseconds kRenewPoll{100};

// Renews the lease of a task while its process runs, on a thread of its own: the process is asked to end when the lease
// is over, whatever the database does.
class LeaseKeeper {
 public:
  using Clock = LeaseClock::Clock;

  /// @param claimed  before the task was claimed
  LeaseKeeper(TaskQueue& queue, const Task& task, std::string video,
              const std::function<void(const std::string&)>& inform, const CancelToken& cancel,
              Clock::time_point claimed)
      : queue_(queue),
        task_(task),
        video_(std::move(video)),
        inform_(inform),
        cancel_(cancel),
        lease_(queue.lease(), queue.lease() / 4, claimed),
        renewer_([this](const std::stop_token& stop) { RenewUntil(stop); }) {}

  /// How the process goes on.
  ChildControl Keep() {
    const std::scoped_lock lock(mutex_);
    SayFailure();
    if (lease_.IsLost(Clock::now())) return ChildControl::kKill;
    return cancel_.IsCancelled() || is_ending_ ? ChildControl::kInterrupt : ChildControl::kContinue;
  }

  /// Ends the thread, which may wait for an answer, and says what it failed at. The queue can then be used again.
  void Stop() {
    renewer_.request_stop();
    if (renewer_.joinable()) renewer_.join();
    SayFailure();
  }

  /// After Stop(): whether the task is to be ended.
  [[nodiscard]] bool is_ending() const { return is_ending_; }
  /// After Stop().
  [[nodiscard]] bool is_lost() const { return lease_.was_lost(); }
  /// Whether the lease was lost because the database did not answer.
  [[nodiscard]] bool is_cut_off() const { return lease_.was_lost() && is_cut_off_; }

 private:
  void RenewUntil(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    while (!stop.stop_requested() && !lease_.IsLost(Clock::now())) {
      if (const auto asked = Clock::now(); lease_.IsDue(asked)) {
        lock.unlock();
        const Status status = Renew();
        lock.lock();
        Enter(status, asked);
      }
      wakes_.wait_for(lock, stop, kRenewPoll, [] { return false; });
    }
  }

  // The lease first: what the process has stored is looked up for the next time.
  Status Renew() {
    VICTORIOUS_ASSIGN_OR_RETURN(const bool goes_on, queue_.Renew(task_, has_progress_));
    is_ending_ = !goes_on;
    has_progress_ = false;
    const Expected<std::int64_t> frames = queue_.Progress(video_);
    if (!frames) return {};
    has_progress_ = frames_ && *frames > *frames_;
    frames_ = *frames;
    return {};
  }

  void SayFailure() {
    if (!failure_.empty()) inform_(fmt::format("{}: {}", video_, std::exchange(failure_, {})));
  }

  // Keeps the first of failures in a row, to be said.
  void Enter(const Status& status, Clock::time_point asked) {
    if (!status && !has_failed_) failure_ = status.error().message;
    has_failed_ = !status;
    const bool is_unanswered = !status && status.error().code == ErrorCode::kUnavailable;
    const bool is_late = lease_.IsLost(Clock::now());
    if (status && is_late) failure_ = "the database has not answered before the lease ended";
    is_cut_off_ = is_unanswered || is_late;  // whatever an answer says that came too late
    lease_.Enter(status, asked);
  }

  TaskQueue& queue_;  ///< of the thread, until it has ended
  const Task& task_;
  std::string video_;
  const std::function<void(const std::string&)>& inform_;
  const CancelToken& cancel_;
  std::optional<std::int64_t> frames_;  ///< of the thread
  bool has_progress_ = false;           ///< of the thread: since the last renewal
  std::atomic<bool> is_ending_ = false;
  std::mutex mutex_;  ///< of what follows
  std::condition_variable_any wakes_;
  LeaseClock lease_;
  std::string failure_;  ///< that was not said yet
  bool has_failed_ = false;
  bool is_cut_off_ = false;
  std::jthread renewer_;  ///< the last member: it uses the others
};

// For messages: the video, and the frames of a segment.
std::string NameOf(const IndexTask& work) {
  if (!work.part) return work.video;
  return fmt::format("{}, frames {} to {}", work.video, work.part->frames.from, work.part->frames.to - 1);
}

bool IsKilled(const ChildEnd& end) { return end.status > kSignalStatus; }

postgres::FailureKind KindOf(const ChildEnd& end) {
  if (!IsKilled(end)) return postgres::FailureKind::kError;
  switch (end.status - kSignalStatus) {
    case SIGKILL:
    case SIGTERM:
    case SIGINT:
    case SIGHUP:
      return postgres::FailureKind::kKilled;
    default:
      return postgres::FailureKind::kCrash;
  }
}

// Whether a process that ends while its worker does was ended by that: by its own error, by the worker, or by who ends
// both.
bool IsEndedWithWorker(const ChildEnd& end) {
  const int signal = end.status - kSignalStatus;
  return !IsKilled(end) || end.is_killed || signal == SIGINT || signal == SIGTERM || signal == SIGHUP;
}

// Lets the task of a video wait for the segments of its cut.
Status WaitForSegments(const Task& task, const IndexTask& work, std::int64_t cut, TaskQueue& queue,
                       SegmentStore& segments, const WorkerOptions& options) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<VideoCut> found, segments.Find(cut));
  if (!found) return queue.Release(task);  // cut anew, or deleted, at this moment
  const std::vector<postgres::NewTask> parts = PartsOf(work, task.key, *found);
  options.inform(fmt::format("{}: cut, {} to be searched", work.video, CountText(parts.size(), "segment")));
  return queue.Wait(task, std::span(parts).first(std::min(parts.size(), options.max_segments)));
}

// What interrupted the process of a task.
enum class Interruption {
  kNothing,
  kTask,    ///< it is to be ended
  kWorker,  ///< which ends
};

// The segments that killed whoever searched them: cut in halves, or left out.
Status GiveUpFatalSegments(const Task& task, TaskQueue& queue, SegmentStore& segments, const WorkerOptions& options) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<postgres::TaskRecord> failed, queue.FatalParts(task));
  for (const postgres::TaskRecord& record : failed) {
    const Expected<IndexTask> work = FromQueue(record.kind, record.payload);
    if (!work || !work->part) continue;
    VICTORIOUS_RETURN_IF_ERROR(segments.GiveUp(work->part->cut, work->part->frames, record.reason));
    VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<VideoCut> cut, segments.Find(work->part->cut));
    const bool is_left_out =
        cut && std::ranges::any_of(cut->segments, [&](const Segment& segment) {
          return segment.frames == work->part->frames && segment.state == SegmentState::kQuarantined;
        });
    options.inform(fmt::format("{}: {}: {}", NameOf(*work), is_left_out ? "left out" : "cut in halves", record.reason));
    // What is left out stays in the list of failures.
    if (!is_left_out) VICTORIOUS_RETURN_IF_ERROR(queue.CloseFailed(record.id));
  }
  return {};
}

// Ends the attempt of a task whose process failed.
Status EndFailed(const Task& task, const IndexTask& work, const ChildEnd& end, TaskQueue& queue,
                 const WorkerOptions& options) {
  const bool is_unavailable = !IsKilled(end) && end.error && end.error->code == ErrorCode::kUnavailable;
  if (is_unavailable) {
    options.inform(fmt::format("{}: waits again: {}", NameOf(work), DescribeFailure(end)));
    return queue.Release(task, options.left_delay);
  }
  options.inform(fmt::format("{}: attempt {} failed: {}", NameOf(work), task.attempt, DescribeFailure(end)));
  return queue.Fail(task, DescribeFailure(end), KindOf(end));
}

// Whether a process could not read its live source any more.
bool IsSourceAway(const ChildEnd& end) {
  if (end.status == 0) return true;
  return !IsKilled(end) && end.error &&
         (end.error->code == ErrorCode::kNotFound || end.error->code == ErrorCode::kDataLoss);
}

// Ends the attempt of a live source, which another one follows.
// @param is_ending  it was asked to end
// Returns whether it is done.
Expected<bool> EndLive(const Task& task, const IndexTask& work, const ChildEnd& end, bool is_ending, TaskQueue& queue,
                       const WorkerOptions& options) {
  if (is_ending && IsEndedWithWorker(end)) {
    VICTORIOUS_RETURN_IF_ERROR(queue.Complete(task));
    options.inform(fmt::format("{}: ended", work.video));
    return true;
  }
  if (!IsSourceAway(end)) {
    VICTORIOUS_RETURN_IF_ERROR(EndFailed(task, work, end, queue, options));
    return false;
  }
  const std::string reason = end.status == 0 ? "the source ended" : DescribeFailure(end);
  options.inform(fmt::format("{}: waits again: {}", work.video, reason));
  VICTORIOUS_RETURN_IF_ERROR(queue.Release(task, options.live_delay, reason));
  return false;
}

// Ends a task in the queue by how its process ended. Returns whether it is done.
Expected<bool> EndTask(const Task& task, const IndexTask& work, const TaskEnd& end, Interruption by, TaskQueue& queue,
                       SegmentStore& segments, const WorkerOptions& options) {
  const bool is_whole = end.child.status == 0 && !work.is_live;
  if (by == Interruption::kWorker && !is_whole && IsEndedWithWorker(end.child)) {
    VICTORIOUS_RETURN_IF_ERROR(queue.Release(task));
    return false;
  }
  if (work.is_live && !end.is_left) {
    return EndLive(task, work, end.child, by == Interruption::kTask, queue, options);
  }
  if (end.child.status != 0) {
    VICTORIOUS_RETURN_IF_ERROR(EndFailed(task, work, end.child, queue, options));
    return false;
  }
  if (end.is_left) {
    options.inform(fmt::format("{}: another process is indexing it: waits again", work.video));
    VICTORIOUS_RETURN_IF_ERROR(queue.Release(task, options.left_delay));
    return false;
  }
  if (end.cut) {
    VICTORIOUS_RETURN_IF_ERROR(WaitForSegments(task, work, *end.cut, queue, segments, options));
    return false;
  }
  VICTORIOUS_RETURN_IF_ERROR(queue.Complete(task));
  options.inform(fmt::format("{}: done", NameOf(work)));
  return true;
}

// What the queue is to be told once it answers again.
struct Unsaid {
  std::optional<Task> lost;          ///< whose lease could not be renewed
  bool is_claim_unanswered = false;  ///< a task may have been claimed
  /// That more tasks were queued.
  std::optional<std::chrono::steady_clock::time_point> queued = {};
};

// Does one task. Returns whether it is done.
// @param claimed  before the task was claimed
Expected<bool> DoTask(const Task& task, LeaseClock::Clock::time_point claimed, TaskQueue& queue, SegmentStore& segments,
                      const RunTask& run, const WorkerOptions& options, const CancelToken& cancel, Unsaid& unsaid) {
  Expected<IndexTask> work = FromQueue(task.kind, task.payload);
  if (!work) {
    VICTORIOUS_RETURN_IF_ERROR(queue.Reject(task, work.error().message));
    return false;
  }
  if (!work->part) VICTORIOUS_RETURN_IF_ERROR(GiveUpFatalSegments(task, queue, segments, options));
  // The last attempt must not kill this worker, too: only a short segment can.
  const bool is_last = task.failures + 1 == kMaxAttempts || task.kills + 1 == kMaxKills;
  if (is_last && !work->part && !work->is_live) {
    work->segment_s = work->segment_s > 0 ? work->segment_s / kShorterSegments : kLastSegment_s;
  }
  work->attempt = TaskAttempt{.task = task.id, .attempt = task.attempt};
  options.inform(fmt::format("{}: begun (attempt {})", NameOf(*work), task.attempt));
  LeaseKeeper keeper(queue, task, work->video, options.inform, cancel, claimed);
  const Expected<TaskEnd> end = run(*work, [&] { return keeper.Keep(); });
  keeper.Stop();
  if (keeper.is_cut_off()) unsaid.lost = task;
  if (!end) {
    VICTORIOUS_RETURN_IF_ERROR(queue.Release(task));
    return std::unexpected(end.error());
  }
  Expected<bool> done = false;
  const Interruption by = keeper.is_ending()     ? Interruption::kTask
                          : cancel.IsCancelled() ? Interruption::kWorker
                                                 : Interruption::kNothing;
  if (!keeper.is_lost()) done = EndTask(task, *work, *end, by, queue, segments, options);
  // Its end was perhaps not entered: it is given back, and found done.
  if (!done && done.error().code == ErrorCode::kUnavailable) unsaid.lost = task;
  if (!keeper.is_lost() && (done || done.error().code != ErrorCode::kConflict)) return done;
  options.inform(fmt::format("{}: its lease was lost: left to another worker", NameOf(*work)));
  return false;
}

enum class Step {
  kDone,   ///< a task was done
  kEnded,  ///< a task was begun and ended, but is not done
  kWait,   ///< no task can be claimed, some are open
  kEmpty,  ///< no task is open
};

Expected<Step> DoNext(TaskQueue& queue, SegmentStore& segments, const RunTask& run, const WorkerOptions& options,
                      const CancelToken& cancel, Unsaid& unsaid) {
  if (unsaid.lost) {
    VICTORIOUS_RETURN_IF_ERROR(queue.Excuse(*unsaid.lost));
    unsaid.lost.reset();
  }
  if (const auto now = std::chrono::steady_clock::now();
      !unsaid.queued || now - *unsaid.queued >= options.queue_interval) {
    VICTORIOUS_RETURN_IF_ERROR(options.queue_more());
    unsaid.queued = now;
  }
  if (std::exchange(unsaid.is_claim_unanswered, true)) VICTORIOUS_RETURN_IF_ERROR(queue.ReleaseOwn());
  const auto now = LeaseClock::Clock::now();
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<Task> task, queue.Claim());
  unsaid.is_claim_unanswered = false;
  if (task) {
    VICTORIOUS_ASSIGN_OR_RETURN(const bool is_done, DoTask(*task, now, queue, segments, run, options, cancel, unsaid));
    return is_done ? Step::kDone : Step::kEnded;
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const bool has_open, queue.HasOpenTasks());
  return has_open ? Step::kWait : Step::kEmpty;
}

// In short steps, so that an interrupt is not kept waiting.
void Pause(std::chrono::milliseconds time, const CancelToken& cancel) {
  const auto end = std::chrono::steady_clock::now() + time;
  while (!cancel.IsCancelled() && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::min(time, kCancelPoll));
  }
}

}  // namespace

RunTask RunIndex(std::vector<std::string> more, WarningSink warn) {
  return [more = std::move(more), warn = std::move(warn)](
             const IndexTask& task, const std::function<ChildControl()>& keep_lease) -> Expected<TaskEnd> {
    std::vector<std::string> arguments = {"index"};
    // Of the options, those that are absolute paths are the files of the task (apps/cli/cmd_submit.cc).
    for (const std::string& option : task.options) {
      arguments.push_back(option.starts_with('/') ? task.root + option : option);
    }
    arguments.insert(arguments.end(), more.begin(), more.end());
    if (task.segment_s > 0) arguments.insert(arguments.end(), {"--cut", fmt::format("{}", task.segment_s)});
    if (task.part) {
      arguments.insert(arguments.end(),
                       {"--frames", fmt::format("{}:{}", task.part->frames.from, task.part->frames.to)});
    }
    if (!task.targets.empty()) arguments.insert(arguments.end(), {"--targets", TargetsText(task.targets)});
    if (task.attempt) {
      arguments.insert(arguments.end(), {"--task", fmt::format("{}:{}", task.attempt->task, task.attempt->attempt)});
    }
    if (!task.content_id.empty()) arguments.insert(arguments.end(), {"--content-id", task.content_id});
    if (!task.covers.empty()) arguments.insert(arguments.end(), {"--covers", task.covers});
    if (task.redo_other) arguments.emplace_back("--redo-other");
    const bool is_moved = !task.root.empty() && !task.is_live && task.covers.empty();
    if (is_moved) arguments.insert(arguments.end(), {"--stored-as", task.video});
    // "--" ends the options, so that the name of a file may begin with a dash.
    arguments.insert(arguments.end(), {"--", is_moved ? task.root + task.video : task.video});
    TaskEnd end;
    const auto read = [&](const ProgramEvent& event) {
      if (const auto* const warning = std::get_if<WarningEvent>(&event)) warn(warning->message);
      end.is_left |= std::holds_alternative<VideoLeftEvent>(event);
      if (const auto* const cut = std::get_if<VideoCutEvent>(&event)) end.cut = cut->cut;
    };
    // Renewed also while the process ends: its lease must not run out meanwhile.
    VICTORIOUS_ASSIGN_OR_RETURN(end.child,
                                RunChild({.command = OwnProgram(arguments), .on_event = read, .control = keep_lease}));
    return end;
  };
}

RunTask RunWithContent(RunTask run, const ContentCache& cache) {
  return [run = std::move(run), &cache](const IndexTask& task,
                                        const std::function<ChildControl()>& keep_lease) -> Expected<TaskEnd> {
    const auto is_stopped = [&] { return keep_lease() != ChildControl::kContinue; };
    const Expected<TaskFiles> files = cache.Provide(task.files, is_stopped);
    if (!files) return TaskEnd{.child = {.status = ExitStatus(files.error().code), .error = files.error()}};
    IndexTask here = task;
    here.root = files->root();
    return run(here, keep_lease);
  };
}

Expected<std::int64_t> Work(TaskQueue& queue, SegmentStore& segments, const RunTask& run, const WorkerOptions& options,
                            const CancelToken& cancel) {
  std::int64_t done = 0;
  Unsaid unsaid;
  std::optional<std::chrono::steady_clock::time_point> failing_since;
  while (!cancel.IsCancelled()) {
    const Expected<Step> step = DoNext(queue, segments, run, options, cancel, unsaid);
    if (!step) {
      const auto now = std::chrono::steady_clock::now();
      if (!failing_since) failing_since = now;
      if (now - *failing_since > kMaxOutage) return std::unexpected(step.error());
      options.inform(step.error().message);
    } else {
      failing_since.reset();
      done += *step == Step::kDone ? 1 : 0;
      if (*step == Step::kEmpty && options.until_empty) return done;
      if (*step == Step::kDone) continue;
    }
    Pause(options.poll, cancel);
  }
  return done;
}

}  // namespace victorious

#include "victorious/cluster/worker.h"

#include <algorithm>
#include <optional>
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
constexpr std::chrono::minutes kMaxOutage{5};  // of the database, that a worker waits out
constexpr int kSignalStatus = 128;             // and the number of the signal that killed a process
constexpr double kShorterSegments = 8;         // to the last attempt of a video

// The positions of the searches of a video, summed over models: a measure of progress.
Expected<std::int64_t> SumNextFrames(std::int64_t video, IndexStore& store) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ModelRecord> models, store.Models());
  std::int64_t frames = 0;
  for (const ModelRecord& model : models) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<SearchRecord> search, store.FindSearch(video, model.id));
    if (search) frames += search->next_frame;
  }
  return frames;
}

// Renews the lease of a task while its process runs.
class LeaseKeeper {
 public:
  LeaseKeeper(TaskQueue& queue, IndexStore& store, const Task& task, std::string video,
              const std::function<void(const std::string&)>& inform, const CancelToken& cancel)
      : queue_(queue),
        store_(store),
        task_(task),
        video_(std::move(video)),
        inform_(inform),
        cancel_(cancel),
        lease_(queue.lease(), queue.lease() / 4, LeaseClock::Clock::now()) {}

  /// How the process goes on.
  ChildControl Keep() {
    if (const auto now = LeaseClock::Clock::now(); lease_.IsDue(now)) {
      const Expected<std::int64_t> frames = Progress();
      const bool has_progress = frames && frames_ && *frames > *frames_;
      const Status status = queue_.Renew(task_, has_progress);
      if (frames) frames_ = *frames;
      Report(!status ? status : frames ? Status() : std::unexpected(frames.error()));
      lease_.Enter(status, now);
    }
    if (lease_.IsLost(LeaseClock::Clock::now())) return ChildControl::kKill;
    return cancel_.IsCancelled() ? ChildControl::kInterrupt : ChildControl::kContinue;
  }

  [[nodiscard]] bool is_lost() const { return lease_.was_lost(); }

 private:
  // All videos of the index are read only until this one is there.
  Expected<std::int64_t> Progress() {
    if (!video_id_) {
      VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<VideoRecord> videos, store_.Videos());
      const auto stored = std::ranges::find(videos, video_, &VideoRecord::name);
      if (stored == videos.end()) return 0;
      video_id_ = stored->id;
    }
    return SumNextFrames(*video_id_, store_);
  }

  // Once for all failures in a row.
  void Report(const Status& status) {
    if (!status && !has_failed_) inform_(fmt::format("{}: {}", video_, status.error().message));
    has_failed_ = !status;
  }

  TaskQueue& queue_;
  IndexStore& store_;
  const Task& task_;
  std::string video_;
  std::optional<std::int64_t> video_id_;  ///< once it is in the index
  const std::function<void(const std::string&)>& inform_;
  const CancelToken& cancel_;
  LeaseClock lease_;
  std::optional<std::int64_t> frames_;
  bool has_failed_ = false;
};

// For messages: the video, and the frames of a segment.
std::string NameOf(const IndexTask& work) {
  if (!work.part) return work.video;
  return fmt::format("{}, frames {} to {}", work.video, work.part->frames.from, work.part->frames.to - 1);
}

bool IsKilled(const ChildEnd& end) { return end.status > kSignalStatus; }

// Lets the task of a video wait for the segments of its cut.
Status WaitForSegments(const Task& task, const IndexTask& work, std::int64_t cut, TaskQueue& queue,
                       SegmentStore& segments, const WorkerOptions& options) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<VideoCut> found, segments.Find(cut));
  if (!found) return queue.Release(task);  // cut anew, or deleted, at this moment
  const std::vector<postgres::NewTask> parts = PartsOf(work, task.key, *found);
  options.inform(fmt::format("{}: cut, {} to be searched", work.video, CountText(parts.size(), "segment")));
  return queue.Wait(task, std::span(parts).first(std::min(parts.size(), options.max_segments)));
}

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
  return queue.Fail(task, DescribeFailure(end), IsKilled(end));
}

// Ends a task in the queue by how its process ended. Returns whether it is done.
Expected<bool> EndTask(const Task& task, const IndexTask& work, const TaskEnd& end, bool is_cancelled, TaskQueue& queue,
                       SegmentStore& segments, const WorkerOptions& options) {
  if (is_cancelled && end.child.status != 0) {
    VICTORIOUS_RETURN_IF_ERROR(queue.Release(task));
    return false;
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

// Does one task. Returns whether it is done.
Expected<bool> DoTask(const Task& task, TaskQueue& queue, IndexStore& store, SegmentStore& segments, const RunTask& run,
                      const WorkerOptions& options, const CancelToken& cancel) {
  Expected<IndexTask> work = FromQueue(task.kind, task.payload);
  if (!work) {
    VICTORIOUS_RETURN_IF_ERROR(queue.Reject(task, work.error().message));
    return false;
  }
  if (!work->part) VICTORIOUS_RETURN_IF_ERROR(GiveUpFatalSegments(task, queue, segments, options));
  // The last attempt must not kill this worker, too: only a short segment can.
  if (task.failures + 1 == kMaxAttempts) work->segment_s /= kShorterSegments;
  options.inform(fmt::format("{}: begun (attempt {})", NameOf(*work), task.attempt));
  LeaseKeeper keeper(queue, store, task, work->video, options.inform, cancel);
  const Expected<TaskEnd> end = run(*work, [&] { return keeper.Keep(); });
  if (!end) {
    VICTORIOUS_RETURN_IF_ERROR(queue.Release(task));
    return std::unexpected(end.error());
  }
  Expected<bool> done = false;
  if (!keeper.is_lost()) done = EndTask(task, *work, *end, cancel.IsCancelled(), queue, segments, options);
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

Expected<Step> DoNext(TaskQueue& queue, IndexStore& store, SegmentStore& segments, const RunTask& run,
                      const WorkerOptions& options, const CancelToken& cancel) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<Task> task, queue.Claim());
  if (task) {
    VICTORIOUS_ASSIGN_OR_RETURN(const bool is_done, DoTask(*task, queue, store, segments, run, options, cancel));
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

RunTask RunIndex(std::vector<std::string> more, std::function<void(const std::string&)> inform) {
  return [more = std::move(more), inform = std::move(inform)](
             const IndexTask& task, const std::function<ChildControl()>& keep_lease) -> Expected<TaskEnd> {
    std::vector<std::string> arguments = {"index"};
    arguments.insert(arguments.end(), task.options.begin(), task.options.end());
    arguments.insert(arguments.end(), more.begin(), more.end());
    if (task.segment_s > 0) arguments.insert(arguments.end(), {"--cut", fmt::format("{}", task.segment_s)});
    if (task.part) {
      arguments.insert(arguments.end(),
                       {"--frames", fmt::format("{}:{}", task.part->frames.from, task.part->frames.to)});
    }
    // "--" ends the options, so that the name of a file may begin with a dash.
    arguments.insert(arguments.end(), {"--", task.video});
    TaskEnd end;
    const auto read = [&](const ProgramEvent& event) {
      if (const auto* const warning = std::get_if<WarningEvent>(&event)) inform("warning: " + warning->message);
      end.is_left |= std::holds_alternative<VideoLeftEvent>(event);
      if (const auto* const cut = std::get_if<VideoCutEvent>(&event)) end.cut = cut->cut;
    };
    // Renewed also while the process ends: its lease must not run out meanwhile.
    VICTORIOUS_ASSIGN_OR_RETURN(end.child,
                                RunChild({.command = OwnProgram(arguments), .on_event = read, .control = keep_lease}));
    return end;
  };
}

Expected<std::int64_t> Work(TaskQueue& queue, IndexStore& store, SegmentStore& segments, const RunTask& run,
                            const WorkerOptions& options, const CancelToken& cancel) {
  std::int64_t done = 0;
  auto answered = std::chrono::steady_clock::now();
  while (!cancel.IsCancelled()) {
    const Expected<Step> step = DoNext(queue, store, segments, run, options, cancel);
    if (!step) {
      if (std::chrono::steady_clock::now() - answered > kMaxOutage) return std::unexpected(step.error());
      options.inform(step.error().message);
    } else {
      answered = std::chrono::steady_clock::now();
      done += *step == Step::kDone ? 1 : 0;
      if (*step == Step::kEmpty && options.until_empty) return done;
      if (*step == Step::kDone) continue;
    }
    Pause(options.poll, cancel);
  }
  return done;
}

}  // namespace victorious

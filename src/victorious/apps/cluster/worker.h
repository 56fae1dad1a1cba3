// A worker: claims tasks of the queue, one at a time, and does each by `victorious index` as a child process. A video
// that crashes a decoder ends its attempt, not the worker.
//
// A long video is cut into segments. Its task prepares it, waits for the segments, which any workers search, and then
// joins them. A segment that kills whoever searches it is cut in halves, and its smallest part left out
// (SegmentStore::GiveUp).
//
// A live source has one owner at a time, which indexes it until it is interrupted, or loses its lease; then another
// worker goes on.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "victorious/apps/cluster/content_cache.h"
#include "victorious/apps/cluster/index_task.h"
#include "victorious/base/cancel.h"
#include "victorious/base/child_task.h"
#include "victorious/base/error.h"
#include "victorious/base/warning_sink.h"
#include "victorious/store/postgres/task_queue.h"
#include "victorious/store/segment_store.h"

namespace victorious {

/// Of the database, that a worker waits out.
inline constexpr std::chrono::minutes kMaxOutage{5};

/// How a task's process ended.
struct TaskEnd {
  ChildEnd child;
  bool is_left = false;                  ///< another process indexes the same video
  std::optional<std::int64_t> cut = {};  ///< whose segments are to be searched first: VideoCut::id
};

struct WorkerOptions {
  bool until_empty = false;               ///< ends once no task of this program is open
  std::chrono::milliseconds poll{1'000};  ///< between claims while no task is queued
  /// Segments of a video that are queued at once. They are joined before the next ones are queued, so that no more
  /// results wait for that in the database, and what is found shows while a long video is searched.
  std::size_t max_segments = 120;
  /// Before a task is claimed again whose video another process indexes, or whose process got no answer from the
  /// database.
  std::chrono::seconds left_delay{30};
  /// Before a live source is opened again that has ended, or does not answer.
  std::chrono::seconds live_delay{5};
  /// Adds tasks before one is claimed, at most each `queue_interval`.
  std::function<Status()> queue_more = []() -> Status { return {}; };
  std::chrono::seconds queue_interval{5};
  std::function<void(const std::string&)> inform = [](const std::string&) {};  ///< one line on each task
};

/// Runs a task's process. Calls `keep_lease`, which renews the task's lease and says how the process goes on, at least
/// every second. Error: the process cannot be started.
/// The process writes under IndexTask::attempt.
using RunTask =
    std::function<Expected<TaskEnd>(const IndexTask& task, const std::function<ChildControl()>& keep_lease)>;

/// Runs `victorious index` of this executable with `more` after the task's options.
/// @param warn  receives its warnings
RunTask RunIndex(std::vector<std::string> more, WarningSink warn);

/// Runs a task by `run` where its files are (ContentCache::Provide), and ends it with the error if they cannot be had.
/// The cache outlives it.
RunTask RunWithContent(RunTask run, const ContentCache& cache);

/// Does tasks until `cancel` is set, or until there are none left. A task
/// - whose process ends well is done, unless another process indexes the same video: then it is released; or the video
///   is cut: then it waits for its segments;
/// - whose process ends because the database does not answer, or is locked by others (kUnavailable), is released;
/// - whose process fails otherwise or crashes is queued again; after kMaxAttempts attempts without progress it has
///   failed, with the reason;
/// - that runs when `cancel` is set is released, and resumed by the next worker;
/// - of a live source whose process ends because the source does is released, and opened again; it is done once it was
///   ended (TaskQueue::End);
/// - of a whole video that killed its process or its worker twice is cut into short segments at its last attempt.
/// - whose process was killed by a signal has failed an attempt, also when `cancel` is set, unless by this worker.
/// Renews the lease while a task runs, on a thread of its own; once it is lost (this worker stood still too long, or
/// the database did not answer), kills the task's process: another worker may have the task, and two must not write the
/// same results.
/// Waits up to 5 minutes for a database that does not answer; then says that a lease was lost by that, which is no
/// failed attempt.
/// @param queue     with TaskQueueOptions::reply_timeout, below the lease
/// @param segments  of the index of the queue
/// Returns the number of tasks done. Errors: those of the database.
[[nodiscard]] Expected<std::int64_t> Work(postgres::TaskQueue& queue, SegmentStore& segments, const RunTask& run,
                                          const WorkerOptions& options, const CancelToken& cancel);

}  // namespace victorious

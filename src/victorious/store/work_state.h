// The vocabulary of the two queues of work: jobs of users (job_queue.h) and tasks of workers (postgres/task_queue.h).
//
//         Submit          Claim           Complete
//   (none) ----> queued -------> running ----------> done
//                  ^                |
//                  '----------------+ Release; Fail and a lost lease, if another attempt is left
//                                   '--------------> failed      Fail, or a lost lease, of the last attempt
//
//   Submit    adds work
//   Claim     takes work for a lease: a new attempt
//   Renew     prolongs the lease; an expired one is that of a dead worker, and lost
//   Complete  ends the work: it is done
//   Fail      ends an attempt that did not do it
//   Release   gives the work back; another worker goes on with it
//
// Work that is queued or running is open. Renewing or ending an attempt whose lease another worker has is a kConflict.
//
// They are two classes, not one interface with two stores, because they differ in what they promise:
//   - a job belongs to a person who sees its progress, may cancel it, and decides after a failure what is to be done:
//     its process failing is final, and only a lost worker gets it another attempt. A task belongs to nobody who
//     watches: it is tried again after growing delays. Both forget lost attempts once they come further.
//   - jobs are claimed on one machine, whose caller gives the time; tasks on many, so only the clock of the database
//     counts.
//   - tasks have a priority, a key and a build of the program that may do them; jobs have none of these.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "victorious/base/enum_text.h"

namespace victorious {

enum class WorkState {
  kQueued,
  kRunning,
  kDone,
  kFailed,
  kCancelled,  ///< of jobs only
};

/// The texts in the databases, the API and messages.
inline constexpr auto kWorkStateTexts = std::to_array<EnumText<WorkState>>({{WorkState::kQueued, "queued"},
                                                                            {WorkState::kRunning, "running"},
                                                                            {WorkState::kDone, "done"},
                                                                            {WorkState::kFailed, "failed"},
                                                                            {WorkState::kCancelled, "cancelled"}});

constexpr std::string_view ToText(WorkState state) { return ToText(kWorkStateTexts, state); }

/// An attempt at a task, which its lease allows to one worker.
struct TaskAttempt {
  std::int64_t task = 0;
  std::int64_t attempt = 0;

  bool operator==(const TaskAttempt&) const = default;
};

/// A task whose attempts end without it coming further has failed after this many: it may be what kills its workers.
inline constexpr int kMaxAttempts = 3;

/// The same of attempts that were killed from outside, or whose worker did not answer any more: a machine that is short
/// of memory or restarted does so again and again, whatever the task.
inline constexpr int kMaxKills = 10;

}  // namespace victorious

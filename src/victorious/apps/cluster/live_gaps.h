// The times of live sources that no worker searched as they came, and that a recorder has: searched from its files.
//
//   gap of a source:        ....searched live]            [searched live....
//   files of the recorder:  |  file 1  |  file 2  |  file 3  |
//   tasks:                             [--][------][---]
//
// A file is looked at once, when its times will not be searched live any more: the owner of the source is past them, or
// there is none. Each part of it that is not covered becomes a task (IndexTask::covers), which covers it.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "victorious/apps/cluster/cluster_status.h"
#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/store/postgres/recording_store.h"
#include "victorious/store/postgres/task_queue.h"

namespace victorious {

/// The parts of a recording in gaps of at least kMinGap_us, also before and after all covered times; frames of other
/// parts are not in them. @param covered  by their beginning
[[nodiscard]] std::vector<UtcInterval> PartsToSearch(const postgres::Recording& recording,
                                                     std::span<const CoveredTime> covered);

/// Enters the complete files of a folder as recordings of a source, and forgets those that were removed.
/// Errors: those of the database; kCancelled.
[[nodiscard]] Status EnterRecordings(const std::string& folder, const std::string& source,
                                     postgres::RecordingStore& store, const CancelToken& cancel);

/// Use from one thread at a time.
class LiveGaps {
 public:
  /// @param program  the build whose sources it looks at
  [[nodiscard]] static Expected<std::unique_ptr<LiveGaps>> Open(const std::string& url, const std::string& program);

  /// Queues what is to be searched from recordings. Returns the number of tasks.
  [[nodiscard]] Expected<std::int64_t> Queue();

 private:
  LiveGaps(std::shared_ptr<postgres::Connection> connection, std::string program);

  /// Error: those of the database.
  [[nodiscard]] Expected<std::int64_t> QueueParts(const postgres::Recording& recording,
                                                  const postgres::TaskRecord& live);

  std::unique_ptr<IndexStore> store_;
  std::unique_ptr<postgres::TaskQueue> queue_;
  std::unique_ptr<postgres::RecordingStore> recordings_;
  std::string program_;
};

}  // namespace victorious

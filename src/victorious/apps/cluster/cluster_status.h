// What workers do: numbers of tasks, rate, time left, what runs and what failed, frames that were left out, and which
// times of live sources were searched. Input:
// an index in a database. Output: a value for `victorious cluster status` and for the page, without the credentials of
// live sources.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/store/postgres/task_queue.h"
#include "victorious/store/segment_store.h"
#include "victorious/store/triage_store.h"

namespace victorious {

/// A task that runs or has failed.
struct ListedTask {
  postgres::TaskRecord record;
  std::string video;                       ///< empty: not a valid task
  std::optional<FrameInterval> frames;     ///< of a segment
  std::optional<std::int64_t> next_frame;  ///< frames before it were searched for each model whose search has begun
};

/// Frames that were left out, of a video by name.
struct ListedGap {
  std::string video;
  CoverageGap gap;
};

/// A segment that kills who searches it, of a video whose other segments are not all searched yet.
struct ListedQuarantine {
  std::string video;
  QuarantinedSegment segment;
};

/// A time between two others, microseconds since 1970, UTC.
struct UtcInterval {
  std::int64_t from_us = 0;
  std::int64_t to_us = 0;

  bool operator==(const UtcInterval&) const = default;
};

/// A live source that is to be indexed.
struct ListedSource {
  postgres::TaskRecord record;
  std::string source;                  ///< its address (base/credentials.h); empty: not a valid task
  std::optional<UtcInterval> covered;  ///< from the first frame that was searched to the last one
  std::optional<double> behind_s;      ///< since the last one; std::nullopt: none was
  std::vector<UtcInterval> gaps;       ///< times in between that were not searched, in order
};

/// Longer times without a frame are gaps in the coverage of a live source.
inline constexpr std::int64_t kMinGap_us = 1'500'000;

/// The times of at least kMinGap_us between covered ones, which may overlap. @param covered  by their beginning
[[nodiscard]] std::vector<UtcInterval> GapsBetween(std::span<const CoveredTime> covered);

struct ClusterStatus {
  postgres::TaskCounts videos;
  postgres::TaskCounts segments;
  std::optional<double> video_s;    ///< mean of the last videos done; std::nullopt: none was done
  std::optional<double> segment_s;  ///< likewise
  /// At the present rate; std::nullopt where it is not known: into how many segments a queued video will be cut.
  std::optional<double> left_s;
  std::vector<ListedTask> tasks;  ///< those that run, then those that have failed; kMaxListed of each at most
  std::vector<ListedGap> gaps;    ///< by video and frame
  std::vector<ListedQuarantine> quarantined;  ///< by video and frame
  std::vector<ListedSource> sources;          ///< in the order in which they were submitted; not counted above

  static constexpr std::int64_t kMaxListed = 1000;
};

/// Reads the status by one connection, which stays open. Use from one thread at a time.
class ClusterReader {
 public:
  /// @param url  of an index that exists. Errors: those of OpenPostgresStore.
  [[nodiscard]] static Expected<std::unique_ptr<ClusterReader>> Open(const std::string& url);

  [[nodiscard]] Expected<ClusterStatus> Read();

 private:
  [[nodiscard]] Expected<std::vector<ListedSource>> ReadSources();

  explicit ClusterReader(std::shared_ptr<postgres::Connection> connection);

  std::unique_ptr<IndexStore> store_;
  std::unique_ptr<TriageStore> searches_;
  std::unique_ptr<postgres::TaskQueue> queue_;
  std::unique_ptr<SegmentStore> segments_;
};

}  // namespace victorious

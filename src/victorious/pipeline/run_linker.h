// From sightings to runs, by region: a sighting that overlaps a run's last one, soon after it, continues that run; any
// other begins a new one. Which runs are one object is decided when all are known (object_list.h).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/pipeline/index_options.h"
#include "victorious/store/index_store.h"

namespace victorious {

/// The runs of one video that may still grow. Results do not depend on how the frames are cut into batches.
class RunLinker {
 public:
  explicit RunLinker(const RunOptions& options) : options_(options) {}

  [[nodiscard]] const RunOptions& options() const { return options_; }

  /// Takes up where an earlier run stopped.
  /// @param sightings  of the video, the last `gap_s` of them at least, in order of frames
  void Resume(std::span<const RunRecord> runs, std::span<const SightingRecord> sightings);

  /// Adds one frame's sightings (of any models) to the batch, each with its run, new or continued. Frames come in
  /// order.
  void Link(std::vector<SightingRecord> sightings, IndexBatch& batch);

  /// Tells the ids that the store gave to the batch's runs. The next batch starts empty.
  void Committed(std::span<const std::int64_t> ids);

 private:
  struct Run {
    RunRecord record;
    std::optional<std::int64_t> id;       // once committed
    std::optional<std::size_t> in_batch;  // its place in the current batch's runs
    Box last_box;
  };

  RunOptions options_;
  std::vector<Run> runs_;
};

}  // namespace victorious

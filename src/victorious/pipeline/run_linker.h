// From sightings to runs. A sighting continues the run
//   - whose last sighting is of the same track (follower.h), whatever the picture shows; or else
//   - whose box, taken on as the picture has moved since and as the object moved over the ground, it overlaps most,
//     unless their lines of sight and ranges cannot be of one thing.
// Any other begins a new run. Which runs are one object is decided when all are known (object_list.h): a run too many
// is joined there by its place, a run that holds two things is never taken apart.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/geometry/similarity.h"
#include "victorious/pipeline/index_options.h"
#include "victorious/store/index_store.h"

namespace victorious {

/// The runs of one video that may still grow. Results do not depend on how the frames are cut into batches.
class RunLinker {
 public:
  explicit RunLinker(const RunOptions& options) : options_(options) {}

  [[nodiscard]] const RunOptions& options() const { return options_; }

  /// How long before a frame sightings may lie that decide how its own are linked.
  [[nodiscard]] double HistoryS() const;

  /// Takes up where an earlier run stopped. Step() follows, for the frames since NeededFrom() and then for the new
  /// ones.
  /// @param sightings  of the video, the last HistoryS() of them at least, in order of frames
  void Resume(std::span<const RunRecord> runs, std::span<const SightingRecord> sightings);

  /// The first frame that a sighting which still counts was in: how the picture moved is asked for from there on.
  /// Nothing where there is none.
  [[nodiscard]] std::optional<std::int64_t> NeededFrom() const;

  /// The next frame. Before Link of its sightings; frames that were told before change nothing.
  /// @param now_from_before  how the picture moved since the frame told before; nothing: as far as is known, not at all
  void Step(std::int64_t frame, const std::optional<Similarity2>& now_from_before);

  /// Adds one frame's sightings (of any models) to the batch, each with its run, new or continued. Frames come in
  /// order.
  void Link(std::vector<SightingRecord> sightings, IndexBatch& batch);

  /// Tells the ids that the store gave to the batch's runs. The next batch starts empty.
  void Committed(std::span<const std::int64_t> ids);

 private:
  // A sighting of a run, where it lies in the picture as it is now.
  struct Seen {
    std::int64_t frame = 0;
    double time_s = 0;
    Box box;
    std::optional<Sight> sight;
  };
  struct Run {
    RunRecord record;
    std::optional<std::int64_t> id;       // once committed
    std::optional<std::size_t> in_batch;  // its place in the current batch's runs
    std::optional<std::int64_t> track;    // of the last sighting
    std::vector<Seen> trail;              // its last sightings
  };

  void See(const SightingRecord& sighting, Run& run);
  [[nodiscard]] static Box Expected(const Run& run, double time_s);
  [[nodiscard]] bool CanBeOne(const Run& run, const SightingRecord& sighting) const;
  [[nodiscard]] std::vector<std::optional<std::size_t>> RunsOf(const std::vector<SightingRecord>& sightings) const;

  RunOptions options_;
  std::vector<Run> runs_;
  std::int64_t recognitions_ = 0;
};

}  // namespace victorious

// Links sightings to tracklets. A sighting continues the tracklet
//   - whose last sighting has the same track id (follower.h); else
//   - with the highest overlap (IoU) with its predicted box, which moves with the camera motion (image registration)
//     and with the object's own velocity. The pair is refused if bearing and range exceed a Mahalanobis gate.
// Any other sighting starts a tracklet. Pairs are assigned greedily, highest overlap first. Association of tracklets to
// objects follows when all tracklets of the index are known (associate_objects.h): it can merge a split tracklet, but
// never splits one that holds two objects.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/base/options.h"
#include "victorious/geometry/similarity.h"
#include "victorious/place/associate/object_options.h"
#include "victorious/store/index_store.h"

namespace victorious {

/// A sighting without a track id starts a new tracklet if the Mahalanobis distance of its bearing and range to the
/// tracklet's place exceeds this. The default of ObjectOptions::merge_gate_sigma, but not tied to it: a split tracklet
/// is merged again as objects are made.
inline constexpr double kTrackletGateSigma = 3.5;

/// Interval of a tracklet's last sightings from which its velocity in the image and its place are estimated, s. Chosen:
/// longer than image noise needs, shorter than an object takes to change its velocity.
inline constexpr double kTrackletTrail_s = 1;

/// How sightings are linked into tracklets.
struct TrackletOptions {
  double gap_s = 2.0;
  /// Minimum intersection over union of a sighting's box with the tracklet's predicted box, which includes camera and
  /// object motion. Not a user parameter.
  double min_overlap = 0.1;
  /// True for tracks of another program: sightings of two of them are never of one tracklet. Not a user parameter.
  bool are_tracks_given = false;

  void ListFields(FieldList& fields);
};

/// The tracklets of one video that may still grow. Results do not depend on how frames are split into batches.
class TrackletLinker {
 public:
  /// @param objects  the error model of bearings, for the gate; the ground is not used. It may change from search to
  ///                 search of an index: tracklets keep the gate that they were linked with
  TrackletLinker(const TrackletOptions& options, ObjectOptions objects);

  [[nodiscard]] const TrackletOptions& options() const { return options_; }

  /// How far back sightings affect the linking of a frame, s.
  [[nodiscard]] double HistorySeconds() const;

  /// Resumes after an interruption. The caller then calls Step() for the frames since FirstRequiredFrame(), then for
  /// the new ones.
  /// @param sightings  of the video, at least the last HistorySeconds(), in order of frames
  void Resume(std::span<const TrackletRecord> tracklets, std::span<const SightingRecord> sightings);

  /// The earliest frame with a sighting that still affects linking: camera motion is needed from there on. std::nullopt
  /// if there is none.
  [[nodiscard]] std::optional<std::int64_t> FirstRequiredFrame() const;

  /// Moves all predicted boxes by the camera motion. Call it for each frame, before Link for its sightings. No effect
  /// on sightings of this frame or later.
  /// @param now_from_before  camera motion since the previous call's frame; std::nullopt if unknown, taken as no motion
  void Step(std::int64_t frame, const std::optional<Similarity2>& now_from_before);

  /// Adds the sightings of one frame (of any models) to the batch, each with a new or a continued tracklet. Frames come
  /// in order.
  void Link(std::vector<SightingRecord> sightings, IndexBatch& batch);

  /// Sets the ids that the store gave to the batch's tracklets. The next batch starts empty.
  void SetCommittedIds(std::span<const std::int64_t> ids);

 private:
  // A sighting of a tracklet, its box moved to the current frame.
  struct TrailEntry {
    std::int64_t frame = 0;
    double time_s = 0;
    Box box;
    std::optional<BearingObservation> observation;
  };
  struct GrowingTracklet {
    TrackletRecord record;
    std::optional<std::int64_t> id;       // set once committed
    std::optional<std::size_t> in_batch;  // index into the current batch's tracklets
    std::optional<std::int64_t> track;    // track id of the last sighting
    std::vector<TrailEntry> trail;        // its sightings of the last second
  };

  void AppendToTrail(const SightingRecord& sighting, GrowingTracklet& tracklet);
  [[nodiscard]] static Box PredictBox(const GrowingTracklet& tracklet, double time_s);
  [[nodiscard]] bool IsConsistent(const GrowingTracklet& tracklet, const SightingRecord& sighting) const;
  [[nodiscard]] std::vector<std::optional<std::size_t>> AssignTracklets(
      const std::vector<SightingRecord>& sightings) const;

  TrackletOptions options_;
  ObjectOptions objects_;
  std::vector<GrowingTracklet> tracklets_;
  std::int64_t recognitions_ = 0;
};

}  // namespace victorious

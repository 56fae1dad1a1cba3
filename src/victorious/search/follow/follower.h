// Tracking between full-frame searches (thesis, section 4.4). Each detection is propagated to the next frame by
// Lucas-Kanade tracking of its matched keypoints (track/region_tracker.h). Only the regions of interest that the tracks
// predict are searched, for the view that matched last and its neighbours. A re-detection becomes the track's new
// template; without one the track gives a `tracked` sighting as long as its appearance check passes.
//
// All tracks restart every `restart_interval_frames` frames, from the full-frame search of that frame. An index that is
// resumed restarts at such a frame, so that its result equals that of an uninterrupted run.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/base/options.h"
#include "victorious/object/features/feature_extractor.h"
#include "victorious/search/recognize/recognizer.h"
#include "victorious/search/recognize/shape_search.h"
#include "victorious/track/region_tracker.h"
#include "victorious/types/detection.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/frame.h"
#include "victorious/types/frame_conditions.h"

namespace victorious {

/// An interval at which tracks do not restart: of a pass that is not resumed, or need not equal an uninterrupted one.
inline constexpr int kNoRestart = 1'000'000;

/// Tracking between full-frame searches.
struct FollowOptions {
  bool enabled = true;  ///< false: every full frame is searched independently
  /// Minimum time between frames that are tracked; in those between, boxes are interpolated (between_frames.h).
  double frame_interval_s = 0.1;
  int restart_interval_frames = 60;  ///< tracked frames after which all tracks restart
  /// Frames in which a track must have been recognised before a tracked sighting counts: false recognitions seldom
  /// repeat. Not a user parameter.
  int min_recognised_frames = 2;
  /// Number of frames before the first detection of a track in which it is followed backward (backward_follower.h); 0:
  /// none. As many frames are held in memory. Not a user parameter.
  int backward_frames = 30;
  /// Minimum time between searches of a visible track's region; in large frames longer (SearchSpacing).
  double search_interval_s = 0.1;
  TrackOptions track;

  void ListFields(FieldList& fields);
};

/// An object in one frame, detected or tracked.
struct ObservedObject {
  Detection detection;  ///< if tracked: the last detection, moved to this frame, with the tracked points as its inliers
  /// The keypoints that the detection's matches index, without descriptors: objects of many frames are held.
  FeatureSet features;
  std::optional<std::int64_t> track;  ///< track id, unique within the video; std::nullopt if no track could be started
  int followed_frames = 0;            ///< frames since the last recognition; 0: recognised in this frame
  bool is_missed = false;             ///< tracked, though a search for its shape did not find it in this frame
  bool starts_track = false;          ///< a detection of the full-frame search that no track explained

  [[nodiscard]] bool tracked() const { return followed_frames > 0; }
};

/// Result of a full-frame search.
struct FullFrameResult {
  const FeatureSet& features;
  const std::vector<Detection>& detections;  ///< best first
};

/// True if two observations in one frame show one object: the same model, in boxes that overlap.
[[nodiscard]] bool AreOneObject(const ObservedObject& a, const ObservedObject& b);

/// The tracks whose regions are searched in a frame.
enum class RegionSearches {
  kAllDue,           ///< each track of which `search_interval_s` has passed, and in every frame those not visible
  kUnconfirmedOnly,  ///< of those due, the ones that need more recognitions to count: for frames that have no time
};

/// The order of the frames that a Follower takes.
enum class FrameOrder {
  kForward,
  kBackward,  ///< against time; tracks do not restart
};

/// Takes frames in order. Deterministic. Not thread-safe; searches the regions of a frame on all cores.
class Follower {
 public:
  /// The references outlive it. Errors: options out of range.
  [[nodiscard]] static Expected<Follower> Create(const Recognizer& recognizer, const FeatureExtractor& extractor,
                                                 const FollowOptions& options, FrameOrder order = FrameOrder::kForward);

  /// Processes the next frame.
  /// @param frame  without impulse noise (RemoveImpulses): a region has too few pixels to detect it
  /// @param whole  result of the full-frame search; std::nullopt if only regions are searched
  /// @return the objects in the frame: first those of the full-frame search, then by track
  /// Errors: those of feature extraction.
  [[nodiscard]] Expected<std::vector<ObservedObject>> Follow(const Frame& frame,
                                                             const std::optional<FullFrameResult>& whole,
                                                             const FrameConditions& conditions,
                                                             RegionSearches searches = RegionSearches::kAllDue);

  /// Objects that were found by their shape are searched for by it in the regions of their tracks, too.
  /// @param shapes  outlives this
  void SearchByShape(const ShapeSearch& shapes) { shapes_ = &shapes; }

  /// True if a track is active.
  [[nodiscard]] bool HasTracks() const { return !tracks_.empty(); }

  /// True if the track of an id (ObservedObject::track) is active.
  [[nodiscard]] bool IsFollowed(std::int64_t track) const;

  /// Ends the active track of an id (ObservedObject::track); without effect if there is none.
  void Stop(std::int64_t track);

 private:
  // State of an active track, apart from its position.
  struct TrackRecord {
    Detection last;  // last recognition
    // Of its full-frame detections: the highest score, the upper bound of a score found in its region; and the cue.
    double max_full_frame_score = 0;
    bool was_found_by_shape = false;
    std::int64_t number = 0;  // track id, by its first frame: does not depend on where the index was interrupted
    int recognised = 0;
    double searched_time_s = 0;  // of the last frame in which its region was searched or it was recognised
  };
  struct Region {
    TrackStep step;
    Expected<FeatureSet> features = FeatureSet{};
    bool is_missed = false;  // a search for its shape found nothing
    std::optional<Detection> found;
  };

  Follower(const Recognizer& recognizer, const FeatureExtractor& extractor, const FollowOptions& options,
           FrameOrder order, RegionTracker tracker)
      : recognizer_(recognizer),
        extractor_(extractor),
        options_(options),
        order_(order),
        tracker_(std::move(tracker)) {}

  std::vector<TrackStep> Step(const Frame& frame);
  /// The track of each detection of a full-frame search among the open ones; std::nullopt: none.
  [[nodiscard]] std::vector<std::optional<std::uint64_t>> FindTracks(std::span<const Detection> detections,
                                                                     std::span<const TrackStep> open) const;
  /// Assigns a detection of a full-frame search to its track, or starts one.
  ObservedObject AssignToTrack(const Detection& detection, const FeatureSet& features, double time_s,
                               std::optional<std::uint64_t> track);
  void Confirm(std::uint64_t track, const Detection& detection, const FeatureSet& features, double time_s);
  void Search(const Frame& frame, const FrameConditions& conditions, Region& region) const;
  [[nodiscard]] Status SearchByKeypoints(const FrameConditions& conditions, Region& region) const;
  [[nodiscard]] Status SearchByShape(const Frame& frame, const FrameConditions& conditions, Region& region) const;
  [[nodiscard]] ObservedObject MakeTrackedObject(const TrackStep& step, const Frame& frame) const;
  [[nodiscard]] bool IsSearchDue(const TrackStep& step, const Frame& frame, RegionSearches searches) const;

  const Recognizer& recognizer_;
  const FeatureExtractor& extractor_;
  FollowOptions options_;
  FrameOrder order_;
  RegionTracker tracker_;
  const ShapeSearch* shapes_ = nullptr;  // null: by keypoints alone
  std::map<std::uint64_t, TrackRecord> tracks_;
  std::int64_t last_number_ = 0;
};

}  // namespace victorious

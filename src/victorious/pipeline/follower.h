// The architecture of the thesis's section 4.4 between whole-frame searches: what was found is followed to the next
// frame (track/region_tracker.h), and there only the regions that tracks lead to are searched, for the view that
// matched last and its neighbours. What the recogniser confirms becomes the track's template; what it does not is a
// `tracked` sighting, as long as it looks as it did.
//
// All tracks begin anew every `restart_frames` frames, from what a whole-frame search finds there: an index that goes
// on after a stop begins at such a frame, and ends as if it had not been stopped.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/base/options.h"
#include "victorious/features/feature_extractor.h"
#include "victorious/recognize/recognizer.h"
#include "victorious/track/region_tracker.h"
#include "victorious/types/detection.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/frame.h"
#include "victorious/types/frame_conditions.h"

namespace victorious {

struct FollowOptions {
  bool enabled = true;
  double least_overlap = 0.3;
  int restart_frames = 60;
  int least_recognised = 2;
  int search_every = 1;
  TrackOptions track;

  void ListFields(FieldList& fields);
};

/// An object seen in a frame.
struct Seen {
  Detection detection;  ///< where it is tracked: the last one's, moved to this frame, resting on the points followed
  FeatureSet features;  ///< that the detection's matches count in; where it is tracked, places without descriptors
  std::optional<std::int64_t> track;  ///< its number in the video; nothing: it could not be followed from here
  int followed_frames = 0;            ///< since the recogniser confirmed it; 0: it found it in this frame

  [[nodiscard]] bool tracked() const { return followed_frames > 0; }
};

/// What a whole-frame search found.
struct WholeFrame {
  const FeatureSet& features;
  const std::vector<Detection>& detections;  ///< best first
};

/// Frames in order. Deterministic. Not thread-safe; searches the regions of a frame on all cores.
class Follower {
 public:
  /// The references outlive it. Errors: options out of range.
  static Expected<Follower> Create(const Recognizer& recognizer, const FeatureExtractor& extractor,
                                   double impulse_share, const FollowOptions& options);

  /// @param whole  nothing where only regions are searched
  /// @return what is seen in the frame: first what the whole-frame search found, then by track
  /// Errors: those of features.
  Expected<std::vector<Seen>> Follow(const Frame& frame, const std::optional<WholeFrame>& whole,
                                     const FrameConditions& conditions);

 private:
  // What is known of an active track beside where it is.
  struct Followed {
    Detection last;           // confirmed
    double surest = 0;        // best score of its finds in whole frames, which one in its region cannot exceed
    std::int64_t number = 0;  // the same however the index was stopped and gone on with
    int recognised = 0;
    std::int64_t searched_frame = 0;  // the last one in which its region was searched, or it was confirmed
  };
  struct Region {
    TrackStep step;
    Expected<FeatureSet> features = FeatureSet{};
    std::optional<Detection> found;
  };

  Follower(const Recognizer& recognizer, const FeatureExtractor& extractor, double impulse_share,
           const FollowOptions& options, RegionTracker tracker)
      : recognizer_(recognizer),
        extractor_(extractor),
        impulse_share_(impulse_share),
        options_(options),
        tracker_(std::move(tracker)) {}

  std::vector<TrackStep> Step(const Frame& frame);
  /// @return the number of the track that it is of by now
  std::optional<std::int64_t> Take(const Detection& detection, const FeatureSet& features, std::int64_t frame,
                                   std::vector<TrackStep>& open);
  void Confirm(std::uint64_t track, const Detection& detection, const FeatureSet& features, std::int64_t frame);
  void Search(const Frame& frame, const FrameConditions& conditions, Region& region) const;
  [[nodiscard]] Seen Tracked(const TrackStep& step, const Frame& frame) const;
  [[nodiscard]] bool IsDue(const TrackStep& step, const Frame& frame) const;

  const Recognizer& recognizer_;
  const FeatureExtractor& extractor_;
  double impulse_share_;
  FollowOptions options_;
  RegionTracker tracker_;
  std::map<std::uint64_t, Followed> tracks_;
  std::int64_t last_number_ = 0;
};

}  // namespace victorious

// track/: point-based tracking of recognised objects. In: frames in order, and the objects that a recogniser found in
// them (outline and matched keypoints). Out: the outline of each object in the following frames, or why it is not seen.
//
// Method (thesis, sections 4.2 and 4.4): the matched keypoints are tracked by pyramidal Lucas-Kanade with a
// forward-backward check (flow.h). A tracked point is kept if the NCC of its patch with the template's patch, warped by
// the last similarity, is at least min_ncc. MLESAC over the kept points fits
//
//   now = scale * R * template + translation
//
// which moves the outline. Lost points are projected by this similarity and re-acquired once their NCC reaches min_ncc.
// The template (outline, points and their patches) comes from the recogniser, by Start() and Confirm(); the tracker
// never changes it. The track therefore does not drift to another object: it is lost instead.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/track/flow.h"
#include "victorious/track/patch.h"
#include "victorious/track/track_options.h"
#include "victorious/types/detection.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/frame.h"
#include "victorious/types/track.h"

namespace victorious {

/// Tracks any number of objects; they share one pyramid per frame. Deterministic. Not thread-safe.
class RegionTracker {
 public:
  /// Errors: kInvalidArgument for options out of range.
  [[nodiscard]] static Expected<RegionTracker> Create(const TrackOptions& options);

  /// Makes `frame` the current frame and moves every active track to it. Frames are in order of time, or all in reverse
  /// order. A track that becomes inactive is reported once more, then removed.
  /// @return one step per track, in the order of Start
  /// Cost at 640 x 480: about 1.5 ms per frame, and 1 ms per track of 50 points.
  std::vector<TrackStep> Step(const Frame& frame);

  /// Starts a track in the current frame. It is inactive at once if fewer than 4 points can be tracked.
  /// @param outline  px, may exceed the frame
  /// @param points   on the object: those of a detection (MatchedPoints), or corners (DetectCorners)
  TrackStep Start(const Polygon& outline, std::span<const TrackPoint> points);

  /// Confirms an active track by a detection in the current frame, which becomes its template.
  TrackStep Confirm(std::uint64_t track, const Polygon& outline, std::span<const TrackPoint> points);

  /// Removes an active track.
  void Stop(std::uint64_t track);

 private:
  struct TemplatePoint {
    TrackPoint origin;  // in the template's frame
    Patch patch;
    Eigen::Vector2d position_px;  // in the frame where it was last seen
    bool is_tracked = true;       // seen in the frame where the track was last seen
  };

  struct Track {
    std::uint64_t id = 0;
    Polygon outline;  // in the template's frame
    std::vector<TemplatePoint> points;
    Similarity2 last_from_template;  // "last": the frame where the track was last seen
    // Of the outline's centroid, in that frame. Empty until the track was moved once; until then the global image
    // motion predicts its motion.
    std::optional<Eigen::Vector2d> velocity_px_s;
    std::shared_ptr<const FlowPyramid> last;  // the frame where the track was last seen
    double last_time_s = 0;
    int missed_frames = 0;
    int unconfirmed_frames = 0;
  };

  // The motion that the tracked points give in a new frame.
  struct MotionEstimate {
    std::vector<std::pair<std::size_t, Eigen::Vector2d>> inliers;  // index and position (px) of each inlier
    Similarity2 now_from_template;
    bool accepted = false;
  };

  explicit RegionTracker(const TrackOptions& options) : options_(options) {}

  [[nodiscard]] std::vector<TemplatePoint> MakeTemplate(std::span<const TrackPoint> points) const;
  [[nodiscard]] Eigen::Vector2d PredictShift(const Track& track) const;
  [[nodiscard]] MotionEstimate EstimateMotion(const Track& track, const Eigen::Vector2d& drift) const;
  void ReacquirePoints(Track& track) const;
  void ApplyMotion(Track& track, const MotionEstimate& estimate) const;
  [[nodiscard]] TrackLoss ClassifyLoss(const Track& track) const;
  TrackStep Advance(Track& track) const;
  [[nodiscard]] TrackStep MakeStep(const Track& track, TrackLoss loss) const;

  TrackOptions options_;
  std::vector<Track> tracks_;
  std::uint64_t next_id_ = 1;
  std::shared_ptr<const FlowPyramid> now_;
  // By the frame where a track without a velocity was last seen: the global image motion from there to `now_`.
  std::map<const FlowPyramid*, Similarity2> image_motions_;
  std::int64_t frame_ = 0;
  double time_s_ = 0;
};

/// The inlier keypoints of a detection in the scene, each with the index of its inlier.
std::vector<TrackPoint> MatchedPoints(const Detection& detection, const FeatureSet& scene);

/// "active", "inactive".
std::string_view Name(TrackState state);
/// "none", "lost-points", "left-frame", "occluded", "unconfirmed".
std::string_view Name(TrackLoss loss);

}  // namespace victorious

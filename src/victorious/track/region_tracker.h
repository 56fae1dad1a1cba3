// track/, in: frames in order, and the objects that a recogniser found in them (outline and matched keypoints). Out:
// where each object is in the following frames, or why that is not known.
//
// Method (thesis, sections 4.2 and 4.4): the recogniser's own matched keypoints are followed by pyramidal Lucas-Kanade,
// on and back again; a point counts if it also still looks like its patch in the template, laid over the frame by the
// last similarity. MLESAC over the points that are left gives
//
//   now = scale * R * template + translation
//
// which moves the outline. Points that were lost are put back where this similarity has them, and taken up again once
// they look right. The template (outline, points and their patches) is the recogniser's last word, given by Start() and
// Confirm(); the tracker never changes it, so that it cannot drift off onto something else: it loses the object
// instead.
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

/// Follows any number of objects; a frame's pyramid is made once for all of them. Deterministic. Not thread-safe.
class RegionTracker {
 public:
  /// Errors: kInvalidArgument for options out of range.
  static Expected<RegionTracker> Create(const TrackOptions& options);

  /// Makes `frame` the present one and moves every active track to it. Frames come in order of time, or all in reverse.
  /// A track that becomes inactive is told once more, then forgotten.
  /// @return one a track, in order of their starts
  /// Cost at 640 x 480: some 1.5 ms a frame, and 1 ms for each track of 50 points.
  std::vector<TrackStep> Step(const Frame& frame);

  /// Begins a track in the present frame. With fewer than least_points that can be followed it is inactive at once.
  /// @param outline  px, may leave the frame
  /// @param points   on the object: of a detection (PointsOf), or chosen (ChoosePoints)
  TrackStep Start(const Polygon& outline, std::span<const TrackPoint> points);

  /// The recogniser's word on an active track in the present frame: these become its template.
  TrackStep Confirm(std::uint64_t track, const Polygon& outline, std::span<const TrackPoint> points);

  /// Forgets an active track.
  void Stop(std::uint64_t track);

 private:
  struct TemplatePoint {
    TrackPoint origin;  // in the template's frame
    Patch patch;
    Eigen::Vector2d place;  // where it was last seen
    bool alive = true;      // in the frame where the track was last seen
  };

  struct Track {
    std::uint64_t id = 0;
    Polygon outline;  // in the template's frame
    std::vector<TemplatePoint> points;
    Similarity2 last_from_template;  // "last": the frame where it was last seen
    // Of the outline's centre, there. Nothing before it was followed once: then it is supposed to have moved as the
    // picture did.
    std::optional<Eigen::Vector2d> velocity_px_s;
    std::shared_ptr<const FlowPyramid> last;  // that frame
    double last_time_s = 0;
    int missed_frames = 0;
    int unconfirmed_frames = 0;
  };

  // What the points say in a new frame.
  struct Sighting {
    std::vector<std::pair<std::size_t, Eigen::Vector2d>> places;  // of the points that agree
    Similarity2 now_from_template;
    bool enough = false;
  };

  explicit RegionTracker(const TrackOptions& options) : options_(options) {}

  [[nodiscard]] std::vector<TemplatePoint> TemplateFrom(std::span<const TrackPoint> points) const;
  [[nodiscard]] Eigen::Vector2d Drift(const Track& track) const;
  [[nodiscard]] Sighting Look(const Track& track, const Eigen::Vector2d& drift) const;
  void TakeUpAgain(Track& track) const;
  void Move(Track& track, const Sighting& sighting) const;
  [[nodiscard]] TrackLoss WhyNotSeen(const Track& track) const;
  TrackStep Advance(Track& track) const;
  [[nodiscard]] TrackStep Describe(const Track& track, TrackLoss loss) const;

  TrackOptions options_;
  std::vector<Track> tracks_;
  std::uint64_t next_id_ = 1;
  std::shared_ptr<const FlowPyramid> now_;
  // Of frames where tracks without a velocity were last seen: how the picture moved from there to `now_`.
  std::map<const FlowPyramid*, Similarity2> picture_moves_;
  std::int64_t frame_ = 0;
  double time_s_ = 0;
};

/// The scene's keypoints that the detection rests on, with the template's that they match.
std::vector<TrackPoint> PointsOf(const Detection& detection, const FeatureSet& scene);

/// "active", "inactive".
std::string_view Name(TrackState state);
/// "none", "lost-points", "left-frame", "occluded", "unconfirmed".
std::string_view Name(TrackLoss loss);

}  // namespace victorious

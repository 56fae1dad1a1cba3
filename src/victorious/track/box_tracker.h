// track/: model-free single-object tracking. In: user boxes around objects, and frames. Out: the box of each object in
// the following frames, also after an occlusion or after it left the frame. No object model is needed. Objects may be
// as small as 20 px.
//
// Method, for each box:
// 1. Predict: move the box by the camera's motion (camera_motion.h) and by the object's own velocity.
// 2. Localise: a correlation filter over gradient and colour cells (correlation_filter.h) gives the position. If the
//    camera has rotated, the rotated box is tested too.
// 3. Confidence: the geometric mean of the response's sharpness (PSR) and of the NCC with the best stored template
//    (appearance.h), each relative to its running mean for this object.
// 4. High confidence: update the filters, the scale (scale_filter.h) and the templates. Low confidence: report the
//    object as lost, update nothing, and search for it at its last position and, by template matching, in the whole
//    frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/track/box_target.h"
#include "victorious/track/box_track_options.h"
#include "victorious/track/camera_motion.h"
#include "victorious/types/frame.h"
#include "victorious/types/track.h"

namespace victorious {

/// The result for one target in one frame.
struct BoxTrackStep {
  std::size_t target = 0;             ///< index in the order of Start, from 0
  TrackLoss loss = TrackLoss::kNone;  ///< kNone if and only if the object is seen
  Box box;                            ///< px, clipped to the frame; empty if not seen
  Box extent;                         ///< px, not clipped; empty if not seen
  double confidence = 0;              ///< confidence, 0 to 1; 1: sharpness and NCC at their usual values
  bool tentative = false;             ///< re-detected by appearance, and not confirmed since

  [[nodiscard]] bool seen() const { return loss == TrackLoss::kNone; }
};

/// Tracks any number of user boxes. Deterministic for any number of threads. Not thread-safe.
class BoxTracker {
 public:
  /// Errors: kInvalidArgument for options out of range.
  [[nodiscard]] static Expected<BoxTracker> Create(const BoxTrackOptions& options);

  /// Makes `frame` the current frame and tracks every target into it, targets in parallel.
  /// Frames are in order of time, or all in reverse order.
  /// @return one result per target
  /// Cost on one core: about 10 ms per target and 3 ms per frame while seen; about twice that while lost.
  std::vector<BoxTrackStep> Step(const Frame& frame);

  /// The part of a user box that is inside a frame.
  /// @param frame_size  px
  /// Errors: kInvalidArgument for a box with a side below 4 px, or with less than half of it inside the frame.
  [[nodiscard]] static Expected<Box> ClipToFrame(const Box& box, cv::Size frame_size);

  /// Starts a target in the current frame. Errors: those of ClipToFrame.
  [[nodiscard]] Expected<BoxTrackStep> Start(const Box& box);

  /// The basis for resuming a lost target at a position; sets the minimum confidence.
  enum class ResumeBasis {
    kRecognised,  ///< recognised there: lost_confidence suffices
    kPredicted,   ///< only predicted there: redetect_confidence is needed
  };

  /// Resumes a lost target at a position in the current frame that another source gives.
  /// @param box  px, with the aspect ratio of the user box; only its centre and size are used
  /// @param rotation_rad  rotation of the object in the image since the user box, from +x towards +y
  /// @return a step that is not seen if the confidence is too low; the target then does not change
  BoxTrackStep Resume(std::size_t target, const Box& box, double rotation_rad, ResumeBasis basis);

  /// Marks a target as lost because the tracked object was not the target.
  void MarkLost(std::size_t target);

  /// Marks all targets as lost: the next frame is of another video.
  void ChangeVideo();

 private:
  explicit BoxTracker(const BoxTrackOptions& options) : options_(options) {}

  [[nodiscard]] BoxTrackStep MakeStep(std::size_t target, const BoxTarget::TargetObservation& observation) const;

  BoxTrackOptions options_;
  ImageMotionEstimator motion_;
  FrameContext context_;
  std::vector<BoxTarget> targets_;
};

}  // namespace victorious

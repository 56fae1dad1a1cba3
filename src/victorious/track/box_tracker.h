// track/, in: boxes that a person drew around anything, and frames. Out: where those things are in the following
// frames, also after they were hidden or out of view. No model of them is known, and they may be 20 px small.
//
// Method, for each box: a correlation filter over gradients and colours (correlation_filter.h) answers where the object
// is, looking where the camera's motion (camera_motion.h) and its own have carried it, and turned if it has turned with
// the camera; another one over sizes tells how much it grew (scale_filter.h). How sharp the answer is and how like the
// object's remembered looks the place is (appearance.h), each against what is usual for this object, make the trust.
// With much trust the filters learn; with little, the object is not seen, nothing is learnt, and it is sought where it
// was, and anywhere in the frame where the picture is like its last sure look.
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

/// What became of one box's object in one frame.
struct BoxStep {
  std::size_t target = 0;             ///< in order of the starts, from 0
  TrackLoss loss = TrackLoss::kNone;  ///< kNone exactly if it is seen
  Box box;                            ///< px, clipped to the frame; empty where it is not seen
  Box extent;                         ///< the same where it goes on beyond the frame, px
  double trust = 0;                   ///< 0 to 1: how much its look and the filter's answer are as usual
  bool doubtful = false;              ///< found again by its look alone, and never since as sure as is usual for it

  [[nodiscard]] bool seen() const { return loss == TrackLoss::kNone; }
};

/// Follows any number of boxes. Deterministic, whatever the number of threads. Not thread-safe.
class BoxTracker {
 public:
  /// Errors: kInvalidArgument for options out of range.
  static Expected<BoxTracker> Create(const BoxTrackOptions& options);

  /// Makes `frame` the present one and looks for every target in it; targets share the machine's cores.
  /// Frames come in order of time, or all in reverse.
  /// @return one a target
  /// Cost: some 10 ms a target and 3 ms a frame on one core, while seen; about twice that while lost.
  std::vector<BoxStep> Step(const Frame& frame);

  /// Begins a target in the present frame.
  /// Errors: kInvalidArgument for a box without area, smaller than 4 px to a side, or not mostly inside the frame.
  Expected<BoxStep> Start(const Box& box);

  /// What tells that a lost target is in some place.
  enum class Evidence {
    kLook,   ///< it was recognised there: the trust to go on with is enough
    kPlace,  ///< it should stand there: it takes the trust to find it again by its look
  };

  /// Goes on with a lost target from here: someone else says that it is there in the present frame.
  /// @param box  of the drawn box's shape: its middle and size count
  /// @param turn_rad  how far the object has turned in the image since its box was drawn, from +x towards +y
  /// @return not seen, and nothing has changed, where it has not the trust
  BoxStep Resume(std::size_t target, const Box& box, double turn_rad, Evidence evidence);

  /// What was followed was not the target: it is lost, and may be anywhere.
  void Lose(std::size_t target);

  /// The next frame is of another video: every target may be anywhere.
  void ChangeVideo();

 private:
  explicit BoxTracker(const BoxTrackOptions& options) : options_(options) {}

  [[nodiscard]] BoxStep Describe(std::size_t target, const BoxTarget::Sight& sight) const;

  BoxTrackOptions options_;
  CameraMotion motion_;
  BoxScene scene_;
  std::vector<BoxTarget> targets_;
};

}  // namespace victorious

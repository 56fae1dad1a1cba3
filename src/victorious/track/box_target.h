// track/, one object that a person drew a box around, followed alone (box_tracker.h follows several).
#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/geometry/box.h"
#include "victorious/geometry/similarity.h"
#include "victorious/track/appearance.h"
#include "victorious/track/box_track_options.h"
#include "victorious/track/correlation_filter.h"
#include "victorious/track/cut_out.h"
#include "victorious/track/scale_filter.h"
#include "victorious/types/track.h"

namespace victorious {

/// What all targets share of one frame.
struct BoxScene {
  Levels image;                 ///< CV_8UC3 or CV_8UC1
  cv::Mat grey;                 ///< CV_8UC1
  Similarity2 now_from_before;  ///< the camera's motion since the frame before
};

class BoxTarget {
 public:
  /// What became of the object in one frame.
  struct Sight {
    TrackLoss loss = TrackLoss::kNone;  ///< kNone, kOccluded or kLeftFrame
    Box box;                            ///< px; may leave the frame; meaningless where it is not seen
    double trust = 0;                   ///< 0 to 1
    bool doubtful = false;              ///< found again by its look alone, and never since as usual
  };

  /// @param box  with an area, mostly in the frame
  BoxTarget(const BoxScene& scene, const Box& box, const BoxTrackOptions& options);

  /// Looks for the object in the next frame.
  Sight Step(const BoxScene& scene);

  /// Goes on from here: someone else says that the object is here in this frame. Nothing changes where the trust is
  /// less than `least_trust`.
  /// @param box  not turned: its middle and size count
  /// @param turn_rad  how far the object has turned in the image since the box was drawn
  Sight Resume(const BoxScene& scene, const Box& box, double turn_rad, double least_trust);

  /// The object may be anywhere, or not be there: in another video, or where it cannot be what was followed.
  void Lose();

  [[nodiscard]] bool lost() const { return lost_frames_ > 0; }

 private:
  struct Answer {
    TurnedBox box;
    double sharpness = 0;
  };

  [[nodiscard]] CellFeatures Look(const Levels& image, const TurnedBox& box) const;
  [[nodiscard]] Answer Ask(const Levels& image, const TurnedBox& about) const;
  [[nodiscard]] Answer AskTurned(const Levels& image);
  [[nodiscard]] double Trust(const Levels& image, const Answer& answer) const;
  void Learn(const BoxScene& scene, const Answer& answer, double trust);
  [[nodiscard]] Sight Seek(const BoxScene& scene);
  [[nodiscard]] std::vector<TurnedBox> PlacesToSeek(const BoxScene& scene) const;

  BoxTrackOptions options_;
  TurnedBox box_;                      // where it was last seen, moved on with the camera
  TurnedBox lost_at_;                  // the same, left where it was
  Eigen::Vector2d velocity_px_{0, 0};  // of its own, a frame, beside the camera's motion
  double pending_turn_rad_ = 0;        // of the camera, not yet asked for in the object
  CorrelationFilter filter_;
  ScaleFilter scale_;
  Appearance appearance_;
  cv::Mat sure_look_;  // grey, when it was last surely seen
  double usual_sharpness_ = 0;
  double usual_likeness_ = 1;
  int learnt_frames_ = 0;
  int lost_frames_ = 0;
  bool doubtful_ = false;  // found again by its look alone, and not learnt since
};

}  // namespace victorious

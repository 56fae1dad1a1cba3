// track/: the tracker of one user box. box_tracker.h runs one for each box and gives the method.
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

/// The data of one frame that all targets share.
struct BoxScene {
  Levels image;                 ///< CV_8UC3 or CV_8UC1
  cv::Mat grey;                 ///< CV_8UC1
  Similarity2 now_from_before;  ///< the camera's motion since the previous frame, px
};

class BoxTarget {
 public:
  /// The result for one frame.
  struct Sight {
    TrackLoss loss = TrackLoss::kNone;  ///< kNone, kOccluded or kLeftFrame
    Box box;                            ///< px; may exceed the frame; undefined if the object is not seen
    double trust = 0;                   ///< 0 to 1
    bool doubtful = false;              ///< re-detected by appearance, and not confirmed since
  };

  /// @param box  px; of positive area, at least half of it inside the frame
  BoxTarget(const BoxScene& scene, const Box& box, const BoxTrackOptions& options);

  /// Tracks the object into the next frame; if it is lost, searches for it again.
  Sight Step(const BoxScene& scene);

  /// Resumes tracking at a position in this frame that another source gives. If the confidence is below
  /// `min_confidence`, the target does not change.
  /// @param box  px, axis-aligned; only its centre and size are used
  /// @param rotation_rad  rotation of the object in the image since the user box, from +x towards +y
  Sight Resume(const BoxScene& scene, const Box& box, double turn_rad, double least_trust);

  /// Marks the target as lost: in another video, or if the tracked object cannot be the target. Step then searches the
  /// whole frame.
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
  TurnedBox box_;                      // last seen, moved with the camera since
  TurnedBox lost_at_;                  // last seen, in the coordinates of that frame
  Eigen::Vector2d velocity_px_{0, 0};  // per frame, relative to the camera's motion
  double pending_turn_rad_ = 0;        // the camera's, not yet tested on the object
  CorrelationFilter filter_;
  ScaleFilter scale_;
  Appearance appearance_;
  cv::Mat sure_look_;  // grey, from the last confident frame
  double usual_sharpness_ = 0;
  double usual_likeness_ = 1;
  int learnt_frames_ = 0;
  int lost_frames_ = 0;
  bool doubtful_ = false;  // re-detected by appearance, and not confirmed since
};

}  // namespace victorious

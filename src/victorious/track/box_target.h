// track/: the tracker of one user box. box_tracker.h runs one for each box and gives the method.
#pragma once

#include <optional>
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
struct FrameContext {
  ImagePyramid image;  ///< CV_8UC3 or CV_8UC1
  cv::Mat grey;        ///< CV_8UC1
  /// The camera's motion since the previous frame, px; std::nullopt: unknown, as after a cut.
  std::optional<Similarity2> now_from_before;
};

class BoxTarget {
 public:
  /// The result for one frame.
  struct TargetObservation {
    TrackLoss loss = TrackLoss::kNone;  ///< kNone, kOccluded or kLeftFrame
    Box box;                            ///< px; may exceed the frame; undefined if the object is not seen
    double confidence = 0;              ///< 0 to 1
    bool tentative = false;             ///< re-detected by appearance, and not confirmed since
  };

  /// @param box  px; of positive area, at least half of it inside the frame
  BoxTarget(const FrameContext& context, const Box& box, const BoxTrackOptions& options);

  /// Tracks the object into the next frame; if it is lost, searches for it again.
  TargetObservation Step(const FrameContext& context);

  /// Resumes tracking at a position in this frame that another source gives. If the confidence is below
  /// `min_confidence`, the target does not change. Nor does it if it cannot be there, unless its place is known.
  /// @param box  px, axis-aligned; only its centre and size are used
  /// @param rotation_rad  rotation of the object in the image since the user box, from +x towards +y
  TargetObservation Resume(const FrameContext& context, const Box& box, double rotation_rad, double min_confidence,
                           bool is_place_known);

  /// Marks the target as lost: in another video, or if the tracked object cannot be the target. Step then searches the
  /// whole frame.
  /// @param position_known  false in another video, and if the tracked object was another: the target may be anywhere.
  ///   Else a re-detection beyond the reach of its motion needs a better fit of the templates
  void MarkLost(bool position_known);

  [[nodiscard]] bool lost() const { return lost_frames_ > 0; }

 private:
  // What is known of the position of a lost target.
  enum class Whereabouts {
    kPredicted,   // by the camera's motion
    kFarOutside,  // outside the frame, too far for a prediction
    kGuessed,     // predicted, but a cut or a way far outside the frame lies between
    kUnknown,     // in another video, or another object was tracked
  };

  struct Localisation {
    RotatedBox box;
    double sharpness = 0;
  };

  [[nodiscard]] CellFeatures ExtractWindow(const ImagePyramid& image, const RotatedBox& box) const;
  [[nodiscard]] Localisation Localise(const ImagePyramid& image, const RotatedBox& search_box) const;
  [[nodiscard]] Localisation LocaliseWithRotation(const ImagePyramid& image);
  [[nodiscard]] double RelativeNcc(const ImagePyramid& image, const RotatedBox& box) const;
  [[nodiscard]] double ComputeConfidence(const ImagePyramid& image, const Localisation& localisation) const;
  void Update(const FrameContext& context, const Localisation& localisation, double confidence);
  [[nodiscard]] TargetObservation Redetect(const FrameContext& context);
  void PredictLost(const FrameContext& context);
  [[nodiscard]] bool IsInReach(const RotatedBox& box, const RotatedBox& from) const;
  [[nodiscard]] bool MayBeAt(const FrameContext& context, const RotatedBox& box);
  [[nodiscard]] double MeasureRival(const FrameContext& context) const;
  [[nodiscard]] std::vector<RotatedBox> FindSimilarPlaces(const FrameContext& context) const;

  BoxTrackOptions options_;
  RotatedBox box_;                     // last seen, moved with the camera since
  RotatedBox last_seen_box_;           // last seen, in the coordinates of that frame
  Eigen::Vector2d velocity_px_{0, 0};  // per frame, relative to the camera's motion
  double pending_rotation_rad_ = 0;    // the camera's, not yet tested on the object
  CorrelationFilter filter_;
  ScaleFilter scale_;
  Appearance appearance_;
  cv::Mat confident_template_;  // grey, from the last confident frame
  double mean_sharpness_ = 0;
  double mean_ncc_ = 1;
  double rival_ncc_ = 0;  // relative NCC of the most similar other object, decaying
  // An object that is not the target.
  struct Other {
    Eigen::Vector2d centre_px;  // moved with the camera
    int unseen_frames = 0;
  };
  std::vector<Other> others_;
  int num_updates_ = 0;
  int lost_frames_ = 0;
  bool tentative_ = false;                             // re-detected by appearance, and not confirmed since
  Whereabouts whereabouts_ = Whereabouts::kPredicted;  // while lost
};

}  // namespace victorious

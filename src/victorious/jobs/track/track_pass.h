// User-specified tracking (track_job.h), one pass over the frames of a video: forward, backward, or over another video.
//
// Per frame, the correlation-filter tracker (track/box_tracker.h) updates every target. Every `recognize_every` frames
// each lost target is searched for: first at the image position that its place on Earth predicts, then by keypoint
// matching against the model made of its box.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"
#include "victorious/geometry/box.h"
#include "victorious/jobs/track/box_sighting.h"
#include "victorious/object/features/feature_extractor.h"
#include "victorious/object/model/photo_model.h"
#include "victorious/place/associate/box_place.h"
#include "victorious/place/cameras/camera_states.h"
#include "victorious/place/observe/box_bearing.h"
#include "victorious/search/recognize/recognizer.h"
#include "victorious/track/box_tracker.h"
#include "victorious/track/ground_point.h"
#include "victorious/types/camera_state.h"
#include "victorious/types/frame.h"
#include "victorious/types/geolocation.h"

namespace victorious {

/// A user box at the start of a pass.
struct UserBoxTarget {
  std::size_t box_index = 0;                               ///< index into the user boxes
  Box box;                                                 ///< px, clipped to the frame
  std::int64_t frame = 0;                                  ///< index of the frame in which the user drew it
  std::shared_ptr<const Recognizer> recognizer = nullptr;  ///< null: too few keypoints in the box
};

/// One image observation of the ground point on which a user box was drawn.
struct UserBoxGroundPoint {
  std::size_t box_index = 0;
  GroundPointObservation seen;
};

/// A static object with a known place, and the box and the camera state when it was drawn.
struct StaticBox {
  Geolocation place;
  Box box;
  CameraState camera;
};

/// Predicts user boxes' objects in another video from their places. Keeps references to its arguments, which must
/// outlive it.
class BoxPlacePrior {
 public:
  /// @param standing  one entry per user box; std::nullopt if the object moves or has no place
  /// @param cameras   camera states of the video
  BoxPlacePrior(const std::vector<std::optional<StaticBox>>& standing, const CameraStates& cameras,
                const BoxPlaceOptions& options)
      : static_boxes_(standing), cameras_(cameras), options_(options) {}

  /// True if the line of sight through `box` misses the object's known place by more than BoxPlaceOptions::gate_sigma:
  /// the box holds another object. False without a place or a camera state.
  [[nodiscard]] bool IsInconsistent(std::size_t box_index, const Box& box, const Frame& frame) const;

  /// The predicted box, which may lie outside the frame. std::nullopt without a place or a camera state.
  [[nodiscard]] std::optional<PredictedBox> Predict(std::size_t box_index, const Frame& frame) const;

 private:
  [[nodiscard]] std::optional<CameraState> CameraAt(const Frame& frame) const;

  const std::vector<std::optional<StaticBox>>& static_boxes_;
  const CameraStates& cameras_;
  const BoxPlaceOptions& options_;
};

/// Makes an object model of an image region, and a recogniser that searches for it by keypoints.
/// Errors: those of MakePhotoModel: too few keypoints.
[[nodiscard]] Expected<std::shared_ptr<const Recognizer>> MakeBoxRecognizer(const Frame& frame, const Box& box,
                                                                            const std::string& name,
                                                                            const PhotoModelOptions& model,
                                                                            const RecognizeOptions& recognize);

class TrackPass {
 public:
  /// @param extractor         outlives the pass
  /// @param recognize_every   frames between two searches for lost targets
  /// @param impulse_fraction  of the frames (RemoveImpulses), if ground points are to be tracked; std::nullopt to track
  ///                          none
  TrackPass(BoxTracker tracker, const FeatureExtractor& extractor, int recognize_every,
            std::optional<double> impulse_fraction)
      : tracker_(std::move(tracker)),
        extractor_(&extractor),
        recognize_every_(recognize_every),
        impulse_fraction_(impulse_fraction) {}

  /// Adds a target in the last processed frame. Returns its box, clipped to the frame.
  /// Errors: those of BoxTracker::Start: a box outside the frame, or too small.
  [[nodiscard]] Expected<Box> Start(const UserBoxTarget& target);

  /// Sets the recogniser of the most recently added target.
  void SetRecognizer(std::shared_ptr<const Recognizer> recognizer);

  /// The next frame belongs to another video: marks all targets lost and stops tracking ground points.
  void ChangeVideo();

  /// Processes the next frame. Appends one sighting per visible target, and the sightings of earlier frames that were
  /// provisional and are now confirmed.
  /// @param place_prior  place priors, or null
  /// Errors: those of FeatureExtractor::Extract.
  [[nodiscard]] Status ProcessFrame(const Frame& frame, std::size_t video, const BoxPlacePrior* place_prior,
                                    std::vector<BoxSighting>& sightings);

  /// Returns and clears the ground point observations since the last call.
  [[nodiscard]] std::vector<UserBoxGroundPoint> TakeGroundPoints() { return std::exchange(ground_points_, {}); }

 private:
  struct TrackedTarget {
    UserBoxTarget target;
    std::vector<BoxSighting> tentative = {};                  // provisional since re-detection; appended once confirmed
    std::optional<GroundPointTracker> ground = std::nullopt;  // ground point on which the box was drawn
    std::optional<Box> last_box = std::nullopt;               // in the previous frame
  };

  // Updates a target from a tracker step.
  // @param recognised  the detection, with score and matches, if the recogniser re-detected the target; else null
  // @return true if the target is visible and consistent with its place
  bool HandleStep(const BoxTrackStep& step, const Frame& frame, std::size_t video, const BoxPlacePrior* place_prior,
                  const Detection* recognised, std::vector<BoxSighting>& sightings);
  [[nodiscard]] cv::Mat CleanGrey(const cv::Mat& image) const;
  void TrackGroundPoints(const Frame& frame);
  bool ResumeAtPlace(std::size_t target, const Frame& frame, std::size_t video, const BoxPlacePrior& place_prior,
                     std::vector<BoxSighting>& sightings);
  [[nodiscard]] Status ResumeByRecognition(std::size_t target, const FeatureSet& scene, const Frame& frame,
                                           std::size_t video, const BoxPlacePrior* place_prior,
                                           std::vector<BoxSighting>& sightings);

  BoxTracker tracker_;
  const FeatureExtractor* extractor_;
  int recognize_every_;
  std::vector<TrackedTarget> targets_;  // in the order of the tracker's targets
  std::int64_t seen_frames_ = 0;
  std::optional<double> impulse_fraction_;
  cv::Mat last_image_;  // kept only if ground points are tracked
  std::vector<UserBoxGroundPoint> ground_points_;
};

}  // namespace victorious

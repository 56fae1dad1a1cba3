// One way through the frames of a video in user-specified tracking (track_run.h): forward, backward, or through another
// video. The tracker follows the boxes' objects; what is lost is looked for where its place is to be seen, and by its
// model.
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
#include "victorious/features/feature_extractor.h"
#include "victorious/geometry/box.h"
#include "victorious/model/photo_model.h"
#include "victorious/pipeline/box_place.h"
#include "victorious/pipeline/box_sighting.h"
#include "victorious/recognize/recognizer.h"
#include "victorious/telemetry/camera_track.h"
#include "victorious/track/box_tracker.h"
#include "victorious/track/ground_spot.h"
#include "victorious/types/camera_state.h"
#include "victorious/types/frame.h"
#include "victorious/types/place.h"

namespace victorious {

/// A drawn box as a pass begins with it.
struct DrawnTarget {
  std::size_t drawn = 0;                                   ///< which of the boxes
  Box box;                                                 ///< clipped to its frame, px
  std::int64_t frame = 0;                                  ///< it was drawn in
  std::shared_ptr<const Recognizer> recognizer = nullptr;  ///< of its model; null where it has not keypoints enough
};

/// Where the ground is to be seen that the object of a drawn box stood on.
struct DrawnSpot {
  std::size_t drawn = 0;
  SpotSighting seen;
};

/// What stands at a known place, and how it was seen where it was drawn.
struct StandingBox {
  Place place;
  Box box;
  CameraState camera;
};

/// What places tell of the drawn boxes' objects in one more video. Refers to what it is given.
class BoxGuide {
 public:
  /// @param standing  by drawn box; nothing for what moves or has no place
  /// @param cameras   of the video; nothing without telemetry
  BoxGuide(const std::vector<std::optional<StandingBox>>& standing, const std::optional<CameraTrack>& cameras,
           const BoxPlaceOptions& options)
      : standing_(standing), cameras_(cameras), options_(options) {}

  /// Whether what is seen there stands elsewhere.
  [[nodiscard]] bool Contradicts(std::size_t drawn, const Box& box, const Frame& frame) const;

  /// Where it is to be seen; may be outside the frame.
  [[nodiscard]] std::optional<SeenBox> Expect(std::size_t drawn, const Frame& frame) const;

 private:
  [[nodiscard]] std::optional<CameraState> CameraAt(const Frame& frame) const;

  const std::vector<std::optional<StandingBox>>& standing_;
  const std::optional<CameraTrack>& cameras_;
  const BoxPlaceOptions& options_;
};

/// A cut of a frame as a model that is searched for by its keypoints.
/// Errors: those of MakePhotoModel: too few keypoints
Expected<std::shared_ptr<const Recognizer>> LearnBox(const Frame& frame, const Box& box, const std::string& name,
                                                     const PhotoModelOptions& model, const RecognizeOptions& recognize);

class BoxPass {
 public:
  /// @param extractor        outlives the pass
  /// @param recognize_every  frames between looks for what is lost
  /// @param impulse_share    of the frames (WithoutImpulses), where the ground is watched, too; else nothing
  BoxPass(BoxTracker tracker, const FeatureExtractor& extractor, int recognize_every,
          std::optional<double> impulse_share)
      : tracker_(std::move(tracker)),
        extractor_(&extractor),
        recognize_every_(recognize_every),
        impulse_share_(impulse_share) {}

  /// Begins in the frame last seen. @return the box, clipped to the frame
  /// Errors: those of BoxTracker::Start: a box outside the frame or too small
  Expected<Box> Start(const DrawnTarget& target);

  /// Gives the target that was started last its model.
  void Equip(std::shared_ptr<const Recognizer> recognizer);

  /// The next frame is another video's: what was seen is lost, and its ground no longer watched.
  void ChangeVideo();

  /// The next frame: adds where each object is seen in it, and where it was seen before that is sure by now.
  /// @param guide  where places are known, else null
  /// Errors: those of FeatureExtractor::Extract
  Status See(const Frame& frame, std::size_t video, const BoxGuide* guide, std::vector<BoxSighting>& sightings);

  /// Where the ground that each object was drawn on was seen since the last call.
  [[nodiscard]] std::vector<DrawnSpot> TakeSpots() { return std::exchange(spots_, {}); }

 private:
  struct Followed {
    DrawnTarget target;
    std::vector<BoxSighting> doubtful = {};           // since it was found again; they count once it is sure
    std::optional<GroundSpot> ground = std::nullopt;  // where it was drawn
    std::optional<Box> last_box = std::nullopt;       // in the frame before
  };

  // @param recognised  by the recogniser, with its score and matches
  // @return whether it is seen, and what is seen may be it
  bool Take(const BoxStep& step, const Frame& frame, std::size_t video, const BoxGuide* guide,
            const Detection* recognised, std::vector<BoxSighting>& sightings);
  [[nodiscard]] cv::Mat Clean(const cv::Mat& image) const;
  void SeeGround(const Frame& frame);
  bool LookWhereItStands(std::size_t target, const Frame& frame, std::size_t video, const BoxGuide& guide,
                         std::vector<BoxSighting>& sightings);
  void Recognise(std::size_t target, const FeatureSet& scene, const Frame& frame, std::size_t video,
                 const BoxGuide* guide, std::vector<BoxSighting>& sightings);

  BoxTracker tracker_;
  const FeatureExtractor* extractor_;
  int recognize_every_;
  std::vector<Followed> followed_;  // in the order of the tracker's targets
  std::int64_t seen_frames_ = 0;
  std::optional<double> impulse_share_;
  cv::Mat last_image_;  // where the ground is watched
  std::vector<DrawnSpot> spots_;
};

}  // namespace victorious

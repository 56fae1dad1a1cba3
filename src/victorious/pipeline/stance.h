// From a detection to how its object stands before the camera: of models that know their points in space (CAD).
//
// Views stand 10 degrees apart; the matched points' places on the object tell the direction between them, and how far
// off the object is (geolocate/object_pose.h). Where telemetry tells how the camera was held, the object is supposed to
// stand upright, give or take.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "victorious/base/options.h"
#include "victorious/geometry/lens.h"
#include "victorious/types/camera_state.h"
#include "victorious/types/detection.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/object_model.h"
#include "victorious/types/stance.h"

namespace victorious {

struct StanceOptions {
  double point_sigma_px = 1.0;
  double view_sigma_deg = 8.0;
  double up_sigma_deg = 3.0;
  double least_view_sigma_deg = 1.0;
  double least_sigma_px = 0.3;
  double least_distance_share = 0.015;
  int hypotheses = 100;

  void ListFields(FieldList& fields);
};

/// The picture's plane at depth 1, the lens undone: of a camera with square pixels, its principal point in the middle.
class ImagePlane {
 public:
  /// @param hfov_rad  full horizontal field of view, (0, pi)
  ImagePlane(const FeatureSet& scene, double hfov_rad, const std::optional<LensDistortion>& lens);

  [[nodiscard]] double focal_px() const { return focal_px_; }
  /// @param pixel  in the scene; may lie outside
  [[nodiscard]] Eigen::Vector2d At(const Eigen::Vector2d& pixel) const;
  [[nodiscard]] Eigen::Vector3d DirectionOf(const Eigen::Vector2d& pixel) const;  ///< of length 1

 private:
  double focal_px_;
  Eigen::Vector2d middle_;
  LensDistortion lens_;
};

/// @param scene   the frame's features, which the detection's matches count in
/// @param camera  at the frame's time, as far as known: without a field of view there is no distance, without an
///                attitude no vertical
/// Nothing for photos, and where the points do not fit.
std::optional<Stance> StanceOf(const Detection& detection, const ObjectModel& model, const FeatureSet& scene,
                               const std::optional<CameraState>& camera, const StanceOptions& options);

}  // namespace victorious

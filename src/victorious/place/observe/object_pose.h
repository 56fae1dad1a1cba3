// Estimates the object pose of a detection: direction, range and rotation relative to the camera, with standard
// deviations.
//
// - Models with 3D points (CAD): perspective-n-point on the matched points (place/geolocate/object_pose.h) gives all 6
//   DoF. This interpolates the direction of view between the rendered views, which are 10 degrees apart. If the
//   vertical is known, a prior keeps the object upright within kUpSigma_deg. The direction is that to the centre of the
//   bounding box.
// - Photos: the direction is that to the centre of the outline; a range only if the object's length is known.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/types.hpp>

#include "victorious/geometry/box.h"
#include "victorious/geometry/rigid3.h"
#include "victorious/place/geolocate/object_pose.h"
#include "victorious/types/camera_state.h"
#include "victorious/types/detection.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/object_model.h"

namespace victorious {

/// Standard deviation of an object's up axis from the vertical, if telemetry gives the attitude (ADR 0012).
inline constexpr double kUpSigma_deg = 3.0;

/// Minimum standard deviation of the direction of view: errors of matched points are correlated (ADR 0012).
inline constexpr double kMinViewSigma_deg = 1.0;

/// Minimum standard deviation of an object's centre, for the same reason.
inline constexpr double kMinCentreSigma_px = 0.3;

/// Maximum number of three-point pose hypotheses.
inline constexpr int kPoseHypotheses = 100;

/// Standard deviation of a photo object's centre over its size (another side has another centre), and relative standard
/// deviation of the range of one of known length (foreshortening). Chosen, not fitted.
inline constexpr double kPhotoCentreFraction = 0.1;
inline constexpr double kPhotoRangeFraction = 0.3;

/// Standard deviation of the centre of a category's object over the longer side of its box. Chosen larger than that of
/// a box drawn by a user (kBoxCentreFraction): in a video the object need not fill the box.
inline constexpr double kCategoryCentreFraction = 0.25;

/// Errors of an object pose. Not user parameters: they follow from the features and from the spacing of views.
struct ObservationOptions {
  /// Standard deviation of a matched keypoint's position in the frame, px. 1.5 and 2 px give larger view errors over
  /// the three development movies (ADR 0012).
  double point_sigma_px = 1.0;
  double view_sigma_deg = 8.0;  ///< of the direction of view from that of the matched view: views are 10 degrees apart
  double min_sigma_px = kMinCentreSigma_px;  ///< minimum standard deviation of the centre, px
  double min_range_fraction = 0.015;         ///< minimum relative standard deviation of the range (ADR 0012)
  double drift_px = 0.05;  ///< standard deviation of the centre added by each frame in which it is only tracked, px
  double drift_range_fraction = 0.002;  ///< relative standard deviation of the range added by each such frame
};

/// Direction of view of an object.
struct ViewEstimate {
  ViewDirection angles;     ///< of the direction to the camera, in the model's frame
  double in_plane_rad = 0;  ///< clockwise image rotation from the rendered view of that direction to the scene
  double sigma_rad = 0;     ///< standard deviation of the direction, each axis
};

struct ObjectPose {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< to the object's centre, unit length, camera frame
  double sigma_rad = 0;                                  ///< about each transverse axis
  std::optional<double> range_m;                         ///< to the object's centre
  double sigma_range_m = 0;                              ///< valid if there is a range
  /// Only of models with 3D points: from the model's axes (x front, y left, z up) about the centre of the bounding box.
  /// If the camera's field of view is unknown, the translation is that of an assumed one.
  std::optional<Rigid3> camera_from_object;
  std::vector<PointObservation> points;  ///< the points of the fit
  double focal_px = 0;                   ///< of the camera, or assumed
  std::optional<ViewEstimate> view;      ///< only of models with 3D points
};

/// The vertical seen by a camera: the unit up vector in the camera's frame. std::nullopt if the attitude is unknown.
[[nodiscard]] std::optional<Eigen::Vector3d> UpInCamera(const CameraState& camera);

/// Estimates the object pose of a detection. std::nullopt if the detection does not determine the object's centre.
/// @param scene         features of the frame, which the detection's matches index
/// @param camera        only field of view and lens are used. Without a field of view the result has no range, and
///                      photos give no result
/// @param up_in_camera  unit up vector for the upright prior; std::nullopt for none
std::optional<ObjectPose> EstimateObjectPose(const Detection& detection, const ObjectModel& model,
                                             const FeatureSet& scene, const CameraState& camera,
                                             const ObservationOptions& options,
                                             const std::optional<Eigen::Vector3d>& up_in_camera = {});

/// Adds the drift of tracking to the standard deviations of direction and range. Tracked points drift off their places
/// on the object, in a common direction as it turns, so the error grows linearly with the number of frames.
/// @param frames  frames since the last recognition; 0 changes nothing
void AddTrackingDrift(ObjectPose& object_pose, int frames, const ObservationOptions& options);

/// Direction to the centre of a box, without further knowledge of its content. std::nullopt if the camera's field of
/// view is unknown.
/// @param image_size       of the frame, px
/// @param centre_fraction  standard deviation of the object's centre over the longer side of the box
std::optional<ObjectPose> EstimateBoxDirection(const Box& box, const cv::Size& image_size, const CameraState& camera,
                                               double centre_fraction);

}  // namespace victorious

// From a detection to how the object stands before the camera: in which direction, how far off, how turned.
//
// Models that know their points in space (CAD): their matched points fix the object's six degrees of freedom
// (geolocate/object_pose.h), and so the direction of view between the views, which stand 10 degrees apart; where the
// vertical is known, the object is supposed to stand upright, give or take. The direction to it is that to the middle
// of the bounding box. Photos: the direction is that to the middle of the outline; a range only where the object's
// length is known.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/types.hpp>

#include "victorious/base/options.h"
#include "victorious/geolocate/object_pose.h"
#include "victorious/geometry/box.h"
#include "victorious/geometry/rigid3.h"
#include "victorious/types/camera_state.h"
#include "victorious/types/detection.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/object_model.h"

namespace victorious {

struct SightOptions {
  double point_sigma_px = 1.0;
  double view_sigma_deg = 8.0;
  double up_sigma_deg = 3.0;
  double least_view_sigma_deg = 1.0;
  double least_sigma_px = 0.3;
  double least_range_share = 0.015;
  int hypotheses = 100;
  double photo_centre_share = 0.1;
  double photo_range_share = 0.3;
  double category_centre_share = 0.25;
  double drift_px = 0.05;
  double drift_range_share = 0.002;

  void ListFields(FieldList& fields);
};

/// From where an object is seen.
struct SeenView {
  ViewAngles angles;        ///< of the direction to the camera, in the model's frame
  double in_plane_rad = 0;  ///< clockwise turn in the image from a view from there, as rendered, to the scene
  double sigma_rad = 0;     ///< of the direction, each axis
};

struct Stance {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< to the object's middle, of unit length, camera's frame
  double sigma_rad = 0;                                  ///< of it, about each axis across
  std::optional<double> range_m;                         ///< to the object's middle
  double sigma_range_m = 0;                              ///< where there is a range
  /// Of models that know their points, from the model's axes (x front, y left, z up) about the middle of the bounding
  /// box. Where the camera's field of view is not known, moved by what a supposed one makes of it.
  std::optional<Rigid3> camera_from_object;
  std::vector<SeenPoint> points;  ///< that tell it
  double focal_px = 0;            ///< known or supposed
  std::optional<SeenView> view;   ///< of models that know their points
};

/// How a camera with a pitch and a roll sees the vertical: its up, of length 1, in the camera's frame; nothing where
/// its attitude is not known.
[[nodiscard]] std::optional<Eigen::Vector3d> UpInCamera(const CameraState& camera);

/// @param scene         the frame's features, which the detection's matches count in
/// @param camera        its field of view and lens, as far as known; nothing else of it counts. Without a field of view
///                      there is no range, and nothing of photos
/// @param up_in_camera  the vertical, of length 1, if the object is to be upright
/// Nothing where the detection does not tell where the object's middle is.
std::optional<Stance> StanceOf(const Detection& detection, const ObjectModel& model, const FeatureSet& scene,
                               const CameraState& camera, const SightOptions& options,
                               const std::optional<Eigen::Vector3d>& up_in_camera = {});

/// Adds what an object's stance errs by more where it was only followed for so many frames since it was recognised:
/// followed points drift off the places on the object that they stand for, all to one side as it turns.
/// @param frames  0 changes nothing
void Age(Stance& stance, int frames, const SightOptions& options);

/// The direction to what a box holds, of which nothing else is known: to the box's middle.
/// @param image_size  the frame's, px
/// Nothing where the camera's field of view is not known.
std::optional<Stance> StanceOfBox(const Box& box, const cv::Size& image_size, const CameraState& camera,
                                  const SightOptions& options);

}  // namespace victorious

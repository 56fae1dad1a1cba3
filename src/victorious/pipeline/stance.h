// From a detection to how the object stands before the camera: in which direction, how far off, how turned.
//
// Models that know their points in space (CAD): their matched points fix the object's six degrees of freedom
// (geolocate/object_pose.h); the direction is that to the middle of the bounding box. Photos: the direction is that to
// the middle of the outline; a range only where the object's length is known.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "victorious/base/options.h"
#include "victorious/geolocate/object_pose.h"
#include "victorious/geometry/rigid3.h"
#include "victorious/types/camera_state.h"
#include "victorious/types/detection.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/object_model.h"

namespace victorious {

struct SightOptions {
  double point_sigma_px = 1.0;
  double view_sigma_deg = 6.0;
  double least_sigma_px = 0.3;
  double least_range_share = 0.01;
  double photo_centre_share = 0.1;
  double photo_range_share = 0.3;

  void ListFields(FieldList& fields);
};

struct Stance {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< to the object's middle, of unit length, camera's frame
  double sigma_rad = 0;                                  ///< of it, about each axis across
  std::optional<double> range_m;
  double sigma_range_m = 0;                  ///< where there is a range
  std::optional<Rigid3> camera_from_object;  ///< of models that know their points: x front, y left, z up
  std::vector<SeenPoint> points;             ///< that tell it
  double focal_px = 0;
};

/// @param scene   the frame's features, which the detection's matches count in
/// @param camera  its field of view and lens; nothing else of it counts
/// Nothing where the field of view is not known, or the detection does not tell where the object's middle is.
std::optional<Stance> StanceOf(const Detection& detection, const ObjectModel& model, const FeatureSet& scene,
                               const CameraState& camera, const SightOptions& options);

}  // namespace victorious

// How an object stands before the camera: its six degrees of freedom, as far as they are known.
#pragma once

#include <optional>

#include "victorious/geometry/rigid3.h"
#include "victorious/types/object_model.h"

namespace victorious {

struct Stance {
  /// From the model's axes about the middle of its bounding box, metres. Where the camera's field of view is not known,
  /// turned as seen along the line of sight, and moved by what a supposed one makes of it.
  Rigid3 camera_from_object;
  ViewAngles view;                   ///< from where the camera looks, seen from the model
  double in_plane_rad = 0;           ///< clockwise turn in the image from a view from there, as rendered, to the scene
  double sigma_view_rad = 0;         ///< of the direction of view, each axis
  double sigma_sight_rad = 0;        ///< of the direction to the object, each axis
  std::optional<double> distance_m;  ///< from the camera to the middle of the bounding box
  double sigma_distance_m = 0;
};

}  // namespace victorious

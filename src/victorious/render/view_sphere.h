// From where an object is looked at: the thesis's sphere of views, a grid of latitude and longitude around the model.
//
// With d the unit vector from the object to the camera in the model frame (x front, y left, z up; mesh.h):
//   off_nadir = acos(d.z), 0 straight above;  azimuth = atan2(d.y, -d.x), 0 behind it, 90 degrees on its left, 180 in
//   front d = (-sin(off_nadir) cos(azimuth), sin(off_nadir) sin(azimuth), cos(off_nadir))
// In the image the model's up points upwards; straight from above, its front does (the limit of azimuth 0).
#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "victorious/base/error.h"
#include "victorious/base/options.h"
#include "victorious/geometry/camera.h"
#include "victorious/render/mesh.h"

namespace victorious {

struct ViewDirection {
  double azimuth_rad = 0;    ///< [0, 2 pi)
  double off_nadir_rad = 0;  ///< [0, pi]
};

/// Neighbours are part of the data, so that no user of a sphere needs to know how it was laid out.
struct ViewSphere {
  struct View {
    ViewDirection direction;
    std::vector<int> neighbours;  ///< indices of views, ascending; mutual
  };
  std::vector<View> views;
};

struct ViewSphereOptions {
  double step_deg = 10.0;           ///< between neighbours, in azimuth and off-nadir; divides 360
  double max_off_nadir_deg = 70.0;  ///< the last ring's, at most

  void ListFields(FieldList& fields);
};

/// The pole, then ring by ring outwards, each from azimuth 0 on: 253 views at the defaults. Neighbours are the up to
/// eight around a view on the grid; the pole's are the whole first ring. Error: kInvalidArgument, options out of range
/// or a step that does not divide 360.
Expected<ViewSphere> MakeViewSphere(const ViewSphereOptions& options);

/// The unit vector from the object to the camera, in the model frame.
[[nodiscard]] Eigen::Vector3d DirectionToCamera(const ViewDirection& direction);
[[nodiscard]] ViewDirection DirectionFromVector(const Eigen::Vector3d& object_to_camera);

/// How a camera is turned that looks at the object from a direction, the image's up as said above.
[[nodiscard]] Eigen::Quaterniond CameraFromModel(const ViewDirection& direction);

/// How large an object is seen.
struct ViewFraming {
  double distance_m = 0;   ///< from the camera to the sphere's centre; more than its radius
  double diameter_px = 0;  ///< of the sphere's outline in the image
  int width_px = 0;
  int height_px = 0;
};

/// The camera that looks at the middle of a sphere from `direction`, with the sphere's outline as large as asked for.
/// The model is the world. Error: kInvalidArgument, a framing that cannot be.
Expected<PosedCamera> CameraForView(const ViewDirection& direction, const Sphere& sphere, const ViewFraming& framing);

}  // namespace victorious

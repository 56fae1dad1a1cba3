// The view sphere: camera directions around the model on a grid of azimuth and off-nadir angle (the thesis's latitude
// and longitude). MakeCadModel renders one template from each.
//
// With d the unit vector from the object to the camera in the model frame (x front, y left, z up; types/mesh.h):
//   off_nadir = acos(d.z): 0 straight above
//   azimuth = atan2(d.y, -d.x): 0 behind the object, 90 degrees on its left, 180 in front
//   d = (-sin(off_nadir) cos(azimuth), sin(off_nadir) sin(azimuth), cos(off_nadir))
// In the image the model's up axis points upwards; straight from above its front does (the limit of azimuth 0).
#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "victorious/base/error.h"
#include "victorious/base/options.h"
#include "victorious/geometry/camera.h"
#include "victorious/geometry/sphere.h"

namespace victorious {

struct ViewDirection {
  double azimuth_rad = 0;    ///< [0, 2 pi)
  double off_nadir_rad = 0;  ///< [0, pi]
};

/// Views with their neighbours. The neighbours are stored, so that users do not depend on the grid layout.
struct ViewSphere {
  struct View {
    ViewDirection direction;
    std::vector<int> neighbours;  ///< indices of views, ascending; mutual
  };
  std::vector<View> views;
};

struct ViewSphereOptions {
  double step_deg = 10.0;           ///< grid step in azimuth and off-nadir angle; must divide 360
  double max_off_nadir_deg = 70.0;  ///< maximum off-nadir angle of the last ring

  void ListFields(FieldList& fields);
};

/// The pole, then the rings outwards, each from azimuth 0 on: 253 views at the defaults. The neighbours of a view are
/// the up to eight adjacent views on the grid; those of the pole are the whole first ring. Error: kInvalidArgument,
/// options out of range or a step that does not divide 360.
[[nodiscard]] Expected<ViewSphere> MakeViewSphere(const ViewSphereOptions& options);

/// The unit vector from the object to the camera, in the model frame.
[[nodiscard]] Eigen::Vector3d DirectionToCamera(const ViewDirection& direction);
[[nodiscard]] ViewDirection DirectionFromVector(const Eigen::Vector3d& object_to_camera);

/// Rotation of a camera that looks at the object from a direction, with the image's up as defined above.
[[nodiscard]] Eigen::Quaterniond CameraFromModel(const ViewDirection& direction);

/// Distance and image size of a view.
struct ViewFraming {
  double distance_m = 0;   ///< from the camera to the sphere's centre; more than its radius
  double diameter_px = 0;  ///< of the sphere's outline in the image
  int width_px = 0;
  int height_px = 0;
};

/// The camera that looks at the centre of `sphere` from `direction`; its focal length gives the sphere's outline the
/// requested diameter. The world frame is the model frame. Error: kInvalidArgument, an impossible framing (distance not
/// above the radius, or a size not above 0).
[[nodiscard]] Expected<PosedCamera> CameraForView(const ViewDirection& direction, const Sphere& sphere,
                                                  const ViewFraming& framing);

}  // namespace victorious
